//! Forward derivatives.

/// Value and derivative: a + b ε with ε² = 0.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Dual<R> {
    /// The value.
    pub value: R,
    /// The derivative along one direction.
    pub slope: R,
}
