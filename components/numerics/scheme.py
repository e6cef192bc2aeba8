"""Numbers of the scheme, for equations in Python and, by way of a written header, in C."""

OF_INCREMENTS = 0.20
OF_RATES = 0.05
"""Shares of k d and k p in the inertial terms of a stiff coordinate, see `stiff_coordinate`."""
NUMERICAL_DAMPING = 0.1
"""Share of k h in the damping of a rough motion, see `fourth_order_correction`."""
ROUGHNESS_SHARE = 0.25
"""Of one step in the roughness, which then follows ringing within a few steps; a stiffness that changed with every step
would be one that iterations do not know."""
LEAST_RATE = 1e-30
"""Added to a sum of rates by which the roughness is divided."""
ROUGH = 1e-2
"""Roughness of a motion from which on means tell its load better than its end."""
LEAST_CHANGE = 1e-5
"""Change of a coordinate (m, rad) below which a discrete gradient is the force at the middle."""
LEAST_SPAN = 1e-9
"""Distance (m) of two points below which the direction of their line is rounding."""
INSTANT = 1e-7
"""Longest step (s) in which nothing moves: that of an impulse, and where loads are those just after an event."""
INSTANT_SHARE = 1e-3
"""Of the step after an event, for loads just after it; a hundredth still showed in a peak of damping."""
AGAIN = 5e-8
"""Step (s) of the impulse that takes what a latch impulse leaves: its size over the numerical inertia of a lock."""
AGAIN_ITERATED = 1e-8
"""Relative tolerance of the iteration in that impulse, which rounding of the one before goes into."""
IMPULSE_ITERATED = 1e-10
"""Relative tolerance of the iteration in an impulse."""
IMPULSE_RESIDUAL = 1.0
"""Of these tolerances: residuals that tell that a larger correction is rounding, as between redundant joints."""
CREST_SURE = 4.0
"""A cubic shows a peak where it rises by more than so many times what it may be off by."""
NEVER = 1e300
"""Time (s) to what is not to come."""
STOPPED = -1.0
"""Size of a step in the record of a load where the step was an impulse, which is no load that lasts."""
FAR_APART = 1e9
"""Elongation (m) that a cut strand lacks to be taut."""
