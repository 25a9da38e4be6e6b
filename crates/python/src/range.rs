//! Ranges whose ends may be infinite, which stands for none.

/// What models have in place of an infinite end, which they refuse: an end that nothing reaches.
const ENDLESS: f64 = 1e30;

/// A range as models have it; `None` where it has no end.
pub fn in_model([lower, upper]: [f64; 2]) -> Option<(f64, f64)> {
    if [lower, upper] == [f64::NEG_INFINITY, f64::INFINITY] {
        return None;
    }
    let lower = lower.clamp(-ENDLESS, f64::INFINITY);
    Some((lower, upper.clamp(f64::NEG_INFINITY, ENDLESS)))
}

/// The two ends of a model's range as Python has them.
pub fn in_python(range: Option<(f64, f64)>) -> [f64; 2] {
    let (lower, upper) = range.unwrap_or((-ENDLESS, ENDLESS));
    let lower = if lower > -ENDLESS {
        lower
    } else {
        f64::NEG_INFINITY
    };
    [
        lower,
        if upper < ENDLESS {
            upper
        } else {
            f64::INFINITY
        },
    ]
}
