"""D-H tables <-> URDF, usable alone: ``table_to_urdf(read_yaml(text))``."""

from dh_to_urdf.errors import DHError, Problem
from dh_to_urdf.mapping import read_mapping
from dh_to_urdf.matrices import DHMatrices, dh_matrices, link_matrix
from dh_to_urdf.par import read_par
from dh_to_urdf.par_writer import table_to_par
from dh_to_urdf.pasted import read_pasted
from dh_to_urdf.readers import read_csv, read_json, read_yaml
from dh_to_urdf.table import Convention, DHRow, DHTable, Inertial, JointType, Limits
from dh_to_urdf.values import split_values
from dh_to_urdf.writer import table_to_urdf

__all__ = [
    "Convention",
    "DHError",
    "DHMatrices",
    "DHRow",
    "DHTable",
    "Inertial",
    "JointType",
    "Limits",
    "Problem",
    "dh_matrices",
    "link_matrix",
    "read_csv",
    "read_json",
    "read_mapping",
    "read_par",
    "read_pasted",
    "read_yaml",
    "split_values",
    "table_to_par",
    "table_to_urdf",
]
