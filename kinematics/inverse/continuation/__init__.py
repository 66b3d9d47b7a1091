"""All inverse solutions of arms without a closed form, by continuation over the complex numbers.

Forward kinematics of a chain with as many joints as its task has rows is an algebraic map: over the
complex numbers every general target has the same number of solutions, its degree. They are found
once for one general complex target (:mod:`fibre`) and followed from there to each real target
(:mod:`following`), where the real ones among them are all solutions there are (:mod:`ends`). On a
general complex way no two solutions meet, as those targets where some do are of lower dimension.

C. Wampler and A. Morgan, Solving the 6R inverse position problem using a generic-case solution
methodology, Mechanism and Machine Theory 26(1), 1991; A. Sommese and C. Wampler, The Numerical
Solution of Systems of Polynomials Arising in Engineering and Science, 2005, chapters 7 and 15.
"""
