"""All solutions of six revolute joints by elimination: eigenvalues of one matrix of 16 rows.

The equations of the fifth joint's axis and of a point on it, their products that are linear in the
sine and cosine of each angle, and the elimination of two angles are those of M. Raghavan and
B. Roth, Inverse kinematics of the general 6R manipulator and related linkages, Journal of
Mechanical Design 115(3), 1993. What it finds are starts: each is brought to a solution by Newton's
method over the complex numbers, and counted.
"""
