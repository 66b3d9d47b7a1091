"""Named singularities: det J as a product of factors with a geometric meaning."""

from kinematics.named_singularities.factorization import (
    Factorization,
    factorization,
    is_prepared,
)
from kinematics.named_singularities.posture import Factor

__all__ = ["Factor", "Factorization", "factorization", "is_prepared"]
