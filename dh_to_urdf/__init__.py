"""D-H tables <-> URDF, usable alone.

``table_to_urdf(read_yaml(text))``; ``extract(read_chain(urdf), Convention.STANDARD).table``.
"""

from dh_to_urdf.cells.values import split_values
from dh_to_urdf.documents.mapping import read_mapping
from dh_to_urdf.documents.readers import read_csv, read_json, read_yaml
from dh_to_urdf.errors import DHError, Fault
from dh_to_urdf.extraction.axes import SerialChain
from dh_to_urdf.extraction.axes_document import read_axes
from dh_to_urdf.extraction.comparison import compare
from dh_to_urdf.extraction.conversion import to_convention
from dh_to_urdf.extraction.explanation import explain
from dh_to_urdf.extraction.extract import Extraction, extract
from dh_to_urdf.extraction.urdf_chain import read_chain
from dh_to_urdf.matrices import DHMatrices, dh_matrices, link_matrix
from dh_to_urdf.par.reader import read_par
from dh_to_urdf.par.writer import table_to_par
from dh_to_urdf.pasted.reader import read_pasted, read_spreadsheet
from dh_to_urdf.table import Convention, DHRow, DHTable, Inertial, JointType, Limits
from dh_to_urdf.writer import table_to_urdf

__all__ = [
    "Convention",
    "DHError",
    "DHMatrices",
    "DHRow",
    "DHTable",
    "Extraction",
    "Fault",
    "Inertial",
    "JointType",
    "Limits",
    "SerialChain",
    "compare",
    "dh_matrices",
    "explain",
    "extract",
    "link_matrix",
    "read_axes",
    "read_chain",
    "read_csv",
    "read_json",
    "read_mapping",
    "read_par",
    "read_pasted",
    "read_spreadsheet",
    "read_yaml",
    "split_values",
    "table_to_par",
    "table_to_urdf",
    "to_convention",
]
