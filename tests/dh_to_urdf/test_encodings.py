import pytest

from dh_to_urdf.encodings import decoded
from dh_to_urdf.errors import DHError

TEXT = "i;θ (°);α;a;d\n1;q1;90;0;0,4\n2;q2;0;0,3;0\n"


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-16-be"])
@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_utf_16_is_detected_and_told(encoding, mark):
    text, warnings = decoded((mark + TEXT).encode(encoding))
    assert text == TEXT
    assert ["UTF-16" in one for one in warnings] == [True]


@pytest.mark.parametrize("encoding", ["utf-32", "utf-32-le", "utf-32-be"])
def test_utf_32_is_refused_by_name(encoding):
    with pytest.raises(DHError, match="UTF-32"):
        decoded(TEXT.encode(encoding))


def test_others_are_as_they_were():
    assert decoded(TEXT.encode()) == (TEXT, [])
    assert decoded(TEXT.encode("utf-16"), "utf-16") == (TEXT, [])
    assert "Windows-1252" in decoded("é;1\n".encode("latin-1"))[1][0]
    assert decoded(b"") == ("", [])
