import numpy as np
import pytest

from dh_to_urdf.poses import rigid_transform, rigid_transforms


@pytest.mark.parametrize("huge", [1e155, 1e200, 1e308, -1e308])
@pytest.mark.parametrize(
    "signs", [[[1, -1, 0], [1, 1, 0], [0, 0, 1]], [[1] * 3] * 3, [[1, 0, 0], [0, 1, 0], [0, 0, 1]]]
)
def test_a_matrix_of_huge_numbers_is_no_rotation_and_warns_of_nothing(huge, signs):
    T = np.eye(4)
    T[:3, :3] = huge * np.array(signs)
    for refused in (lambda: rigid_transform(T), lambda: rigid_transforms(np.stack([np.eye(4), T]))):
        with pytest.raises(ValueError, match="no rotation"):
            refused()
