"""The inverse model on paper: derived in steps from the symbols of a D-H table.

``derive(table, request)`` gives the steps of Paul's and Pieper's methods; they are written for
people (:func:`model_view`) and as functions that run alone (:func:`model_source`).
"""

from kinematics.symbolic.inverse_model.derive import NoClosedForm, derive
from kinematics.symbolic.inverse_model.evaluation import evaluated
from kinematics.symbolic.inverse_model.sources import model_source
from kinematics.symbolic.inverse_model.statements import Derivation
from kinematics.symbolic.inverse_model.view import model_view

__all__ = ["Derivation", "NoClosedForm", "derive", "evaluated", "model_source", "model_view"]
