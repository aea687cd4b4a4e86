//! Overlap of an inner sphere tree with a shape that is not one.
//!
//! Each ball of the tree meets the other shape as if that were the half-space behind its nearest point: a spherical
//! cap of height h has volume πh²(3r−h)/3 and base area πh(2r−h). Exact for half-spaces, good where the
//! balls are small against the other shape's features, too much against parts thinner than a ball.
