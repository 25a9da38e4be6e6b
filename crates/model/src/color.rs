//! Colours of what has none of its own.

use crate::BodyId;

/// What belongs to the world.
const WORLD: [f32; 3] = [0.80, 0.80, 0.79];

/// Twelve hues of like lightness and saturation (OKLCH: lightness 0.66 to 0.74, chroma 0.115, hues 30°
/// apart), five steps of hue from each to the next, so that neighbours differ most.
const BODIES: [[f32; 3]; 12] = [
    [0.39, 0.64, 0.89],
    [0.81, 0.47, 0.35],
    [0.22, 0.76, 0.73],
    [0.81, 0.51, 0.71],
    [0.48, 0.63, 0.32],
    [0.61, 0.64, 0.95],
    [0.80, 0.57, 0.28],
    [0.11, 0.63, 0.76],
    [0.91, 0.55, 0.60],
    [0.33, 0.71, 0.52],
    [0.66, 0.49, 0.78],
    [0.74, 0.68, 0.31],
];

/// Colour in sRGB and opacity, each 0 to 1, of the shapes of a body that have none of their own: one of
/// twelve, in turn; a neutral grey for the world's.
pub fn default_color(body: Option<BodyId>) -> [f32; 4] {
    let [red, green, blue] = body.map_or(WORLD, |body| BODIES[body.0 % BODIES.len()]);
    [red, green, blue, 1.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bodies_in_a_row_differ_from_each_other_and_from_the_world() {
        let color = |body: usize| default_color(Some(BodyId(body)));
        let apart = |a: [f32; 4], b: [f32; 4]| {
            let square = a.iter().zip(b).map(|(a, b)| (a - b).powi(2));
            square.sum::<f32>().sqrt()
        };
        for body in 0..BODIES.len() {
            assert_eq!(color(body), color(body + BODIES.len()));
            assert!(apart(color(body), color(body + 1)) > 0.3);
            assert!(apart(color(body), default_color(None)) > 0.15);
        }
    }
}
