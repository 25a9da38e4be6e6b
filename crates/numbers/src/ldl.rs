//! L D Lᵀ of small symmetric matrices that may be singular.

use crate::Real;

/// A positive semidefinite matrix as L D Lᵀ, without the rows that hang on those before them.
///
/// Row by row, dⱼ = aⱼⱼ − Σ lⱼₖ² dₖ is what of a row no row before it has. Where it is as small as rounding,
/// the row says nothing new, and is left out: its unknown is zero, and the others are solved as if it were not there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ldl<R, const N: usize> {
    /// Below the diagonal: L. On it: 1 / d, zero for a row that is left out. Above it: nothing of use.
    pub rows: [[R; N]; N],
}

impl<R: Real, const N: usize> Ldl<R, N> {
    /// Factors the matrix whose lower triangle is given; rows whose d is not above `least` are left out.
    #[inline(always)]
    #[allow(clippy::needless_range_loop)] // iterators of arrays are not sure to be inlined
    pub fn new(a: [[R; N]; N], least: [R; N]) -> Self {
        let mut l = a;
        // L D, whose diagonal is not needed.
        let mut scaled = a;
        for j in 0..N {
            let mut d = a[j][j];
            for k in 0..j {
                d = l[j][k].fnma(scaled[j][k], d);
            }
            let kept = d.gt(least[j]);
            let inverse = R::select(kept, R::select(kept, d, R::one()).recip(), R::zero());
            l[j][j] = inverse;
            for i in j + 1..N {
                let mut x = a[i][j];
                for k in 0..j {
                    x = l[i][k].fnma(scaled[j][k], x);
                }
                scaled[i][j] = x;
                l[i][j] = x * inverse;
            }
        }
        Self { rows: l }
    }

    /// Solves L D Lᵀ x = b; the x of a row that was left out is zero.
    #[inline(always)]
    #[allow(clippy::needless_range_loop)]
    pub fn solve(&self, b: [R; N]) -> [R; N] {
        let l = &self.rows;
        let mut x = b;
        for i in 0..N {
            for k in 0..i {
                x[i] = l[i][k].fnma(x[k], x[i]);
            }
        }
        for i in 0..N {
            x[i] *= l[i][i];
        }
        for down in 1..=N {
            let i = N - down;
            for k in i + 1..N {
                x[i] = l[k][i].fnma(x[k], x[i]);
            }
        }
        x
    }

    /// 1 for each row that was left out, else 0.
    #[inline(always)]
    #[allow(clippy::needless_range_loop)]
    pub fn left_out(&self) -> [R; N] {
        let mut out = [R::zero(); N];
        for i in 0..N {
            out[i] = R::select(self.rows[i][i].same(R::zero()), R::one(), R::zero());
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: [[f64; 4]; 3] = [
        [2.0, -1.0, 0.5, 3.0],
        [0.3, 1.7, -2.0, 0.1],
        [1.0, 0.0, 0.2, -0.4],
    ];

    /// B Bᵀ of rows.
    fn gram<const N: usize>(rows: [[f64; 4]; N]) -> [[f64; N]; N] {
        let dot = |i: usize, j: usize| (0..4).map(|k| rows[i][k] * rows[j][k]).sum();
        std::array::from_fn(|i| std::array::from_fn(|j| dot(i, j)))
    }

    fn times<const N: usize>(a: [[f64; N]; N], x: [f64; N]) -> [f64; N] {
        std::array::from_fn(|i| (0..N).map(|k| a[i][k] * x[k]).sum())
    }

    #[test]
    fn a_regular_matrix_is_solved() {
        let (a, x) = (gram(A), [0.7, -1.3, 2.0]);
        let found = Ldl::new(a, [1e-12; 3]).solve(times(a, x));
        for (found, x) in found.into_iter().zip(x) {
            assert!((found - x).abs() < 1e-12, "{found} {x}");
        }
    }

    /// Rows 1 and 3 hang on others: without them the rest is solved, and meets all equations.
    #[test]
    fn rows_that_hang_on_others_are_left_out() {
        let sum: [f64; 4] = std::array::from_fn(|k| 2.0 * A[0][k] - A[2][k]);
        let a = gram([A[0], [0.0; 4], A[2], sum]);
        let b = times(a, [1.0, 5.0, -2.0, 0.5]);
        let factor = Ldl::new(a, [1e-12; 4]);
        assert_eq!(factor.left_out(), [0.0, 1.0, 0.0, 1.0]);
        let x = factor.solve(b);
        assert_eq!([x[1], x[3]], [0.0; 2]);
        for (found, b) in times(a, x).into_iter().zip(b) {
            assert!((found - b).abs() < 1e-12, "{found} {b}");
        }
    }
}
