//! A kernel recorded instead of run.
