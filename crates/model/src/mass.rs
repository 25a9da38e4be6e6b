//! Mass, centre of mass and inertia of homogeneous solids and of what is put together from them.

use crate::{Geometry, Pose, Shape};
use glam::{DMat3, DQuat, DVec3};
use std::f64::consts::PI;

/// A principal moment below this share of the largest counts as zero.
pub(crate) const LEAST_MOMENT: f64 = 1e-12;

/// Mass, centre of mass and inertia of a rigid body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassProperties {
    /// Mass [kg].
    pub mass: f64,
    /// Centre of mass [m].
    pub center: DVec3,
    /// Inertia [kg·m²] about the centre of mass, along the frame's axes.
    pub inertia: DMat3,
}

impl MassProperties {
    /// Of a homogeneous solid of a density [kg/m³], in the solid's own frame.
    ///
    /// `None` for what holds no volume, a plane and a mesh that is [open](crate::TriangleMesh::is_closed)
    /// or inside out, and for the file of a mesh, which is not read here.
    ///
    /// Closed forms, with m the mass, r the radius, h half the height (along y), about the centre
    /// of mass; e.g. Beer & Johnston, Vector Mechanics for Engineers: Dynamics, appendix B:
    ///
    /// ```text
    /// ellipsoid  V = 4/3 π abc    Ixx = m (b² + c²)/5, and in turn
    /// box        V = 8 abc        Ixx = m (b² + c²)/3, and in turn
    /// cylinder   V = 2 π r² h     Iyy = m r²/2      Ixx = Izz = m (r²/4 + h²/3)
    /// cone       V = 2/3 π r² h   Iyy = 3/10 m r²   Ixx = Izz = 3/20 m (r² + h²)   centre at −h/2
    /// ```
    ///
    /// A capsule is a cylinder of half height k = h − r and mass mc, and two half balls of mass ms
    /// together, whose centres of mass lie 3/8 r beyond the cylinder's ends:
    ///
    /// ```text
    /// Iyy = mc r²/2 + 2/5 ms r²   Ixx = Izz = mc (r²/4 + k²/3) + ms (2/5 r² + k² + 3/4 k r)
    /// ```
    ///
    /// Hulls and closed meshes are sums of tetrahedra from one point to their faces (a, b, c), of volumes
    /// V, negative where a face looks at that point; C = ∫ x xᵀ dV (Tonon, Explicit exact formulas for
    /// the 3-D tetrahedron inertia tensor, 2004):
    ///
    /// ```text
    /// V = a · (b × c)/6   centre = Σ V/4 s / Σ V, s = a + b + c   about that
    /// C = Σ V/20 (a aᵀ + b bᵀ + c cᵀ + s sᵀ)   I = tr C 1 − C
    /// ```
    pub fn of(geometry: &Geometry, density: f64) -> Option<Self> {
        let (mass, center, moments) = match *geometry {
            Geometry::Plane { .. } | Geometry::MeshFile { .. } => return None,
            Geometry::Hull(ref hull) => return polyhedron(hull.faces(), hull.center(), density),
            Geometry::Mesh(ref mesh) if mesh.is_closed() && mesh.volume() > 0.0 => {
                return polyhedron(mesh.faces(), mesh.center(), density);
            }
            Geometry::Mesh(_) => return None,
            Geometry::Sphere { radius } => ellipsoid(DVec3::splat(radius), density),
            Geometry::Ellipsoid { half } => ellipsoid(half, density),
            Geometry::Box { half } => {
                let m = density * 8.0 * half.element_product();
                (m, DVec3::ZERO, m / 3.0 * others_squared(half))
            }
            Geometry::Cylinder {
                radius: r,
                half_height: h,
            } => {
                let m = density * 2.0 * PI * r * r * h;
                (
                    m,
                    DVec3::ZERO,
                    about_y(m * r * r / 2.0, m * (r * r / 4.0 + h * h / 3.0)),
                )
            }
            Geometry::Cone {
                radius: r,
                half_height: h,
            } => {
                let m = density * 2.0 / 3.0 * PI * r * r * h;
                let moments = about_y(0.3 * m * r * r, 0.15 * m * (r * r + h * h));
                (m, DVec3::new(0.0, -h / 2.0, 0.0), moments)
            }
            Geometry::Capsule {
                radius: r,
                half_height: h,
            } => {
                let k = h - r;
                let mc = density * 2.0 * PI * r * r * k;
                let ms = density * 4.0 / 3.0 * PI * r * r * r;
                let along = mc * r * r / 2.0 + 0.4 * ms * r * r;
                let across =
                    mc * (r * r / 4.0 + k * k / 3.0) + ms * (0.4 * r * r + k * k + 0.75 * k * r);
                (mc + ms, DVec3::ZERO, about_y(along, across))
            }
        };
        Some(Self {
            mass,
            center,
            inertia: DMat3::from_diagonal(moments),
        })
    }

    /// Of a body made of these shapes, in the body's frame. Shapes without volume and shapes of
    /// density zero count nothing; `None` where nothing counts.
    pub fn of_shapes<'a>(shapes: impl IntoIterator<Item = &'a Shape>) -> Option<Self> {
        let solid = |s: &Shape| Some(Self::of(&s.geometry, s.density)?.placed(&s.pose));
        shapes
            .into_iter()
            .filter_map(solid)
            .filter(|m| m.mass > 0.0)
            .reduce(|a, b| a.and(&b))
    }

    /// The same solid, given in its own frame, seen from the frame in which that frame has this
    /// pose: I ← R I Rᵀ.
    pub fn placed(&self, pose: &Pose) -> Self {
        let r = DMat3::from_quat(pose.orientation);
        let inertia = r * self.inertia * r.transpose();
        Self {
            mass: self.mass,
            center: pose.point(self.center),
            inertia,
        }
    }

    /// Both solids as one, by the parallel axis theorem: I = Σ Iᵢ + mᵢ (|d|² 1 − d dᵀ), with d the
    /// way from the common centre of mass to the solid's. Their masses must not both be zero.
    pub fn and(&self, other: &Self) -> Self {
        let mass = self.mass + other.mass;
        let center = (self.mass * self.center + other.mass * other.center) / mass;
        let inertia = self.inertia_about(center) + other.inertia_about(center);
        Self {
            mass,
            center,
            inertia,
        }
    }

    /// Inertia [kg·m²] about a point, along the frame's axes.
    pub fn inertia_about(&self, point: DVec3) -> DMat3 {
        let d = self.center - point;
        let squared = DMat3::from_diagonal(DVec3::splat(d.length_squared()));
        self.inertia + self.mass * (squared - outer(d))
    }

    /// The same distribution with another total mass [kg].
    pub fn with_mass(&self, mass: f64) -> Self {
        Self {
            mass,
            center: self.center,
            inertia: self.inertia * (mass / self.mass),
        }
    }

    /// Whether a body can move by it alone, as a model asks of those that are dynamic: its mass and all principal moments
    /// are above zero. A point mass cannot, nor can masses on a line.
    pub fn is_definite(&self) -> bool {
        let (moments, _) = self.principal();
        self.mass > 0.0 && moments.min_element() > LEAST_MOMENT * moments.max_element()
    }

    /// Principal moments [kg·m²] and the orientation of the principal axes in the frame:
    /// inertia = R diag(moments) Rᵀ. A diagonal inertia keeps its order, and R is the identity.
    pub fn principal(&self) -> (DVec3, DQuat) {
        let (moments, axes) = eigen(self.inertia);
        (moments, DQuat::from_mat3(&axes).normalize())
    }
}

fn ellipsoid(half: DVec3, density: f64) -> (f64, DVec3, DVec3) {
    let m = density * 4.0 / 3.0 * PI * half.element_product();
    (m, DVec3::ZERO, m / 5.0 * others_squared(half))
}

/// Of what a closed surface holds; a point near it spares digits. `None` where it holds nothing.
fn polyhedron(
    faces: impl Iterator<Item = [DVec3; 3]> + Clone,
    near: DVec3,
    density: f64,
) -> Option<MassProperties> {
    let (mut volume, mut first) = (0.0, DVec3::ZERO);
    for [a, b, c] in faces.clone().map(|face| face.map(|corner| corner - near)) {
        let part = a.dot(b.cross(c)) / 6.0;
        volume += part;
        first += (a + b + c) * (part / 4.0);
    }
    if volume <= 0.0 {
        return None;
    }
    let center = near + first / volume;
    let mut second = DMat3::ZERO;
    for [a, b, c] in faces.map(|face| face.map(|corner| corner - center)) {
        let part = a.dot(b.cross(c)) / 6.0;
        for x in [a, b, c, a + b + c] {
            second += outer(x) * (part / 20.0);
        }
    }
    let trace = second.x_axis.x + second.y_axis.y + second.z_axis.z;
    Some(MassProperties {
        mass: density * volume,
        center,
        inertia: (DMat3::from_diagonal(DVec3::splat(trace)) - second) * density,
    })
}

/// x xᵀ
fn outer(x: DVec3) -> DMat3 {
    DMat3::from_cols(x * x.x, x * x.y, x * x.z)
}

/// (b² + c², c² + a², a² + b²)
fn others_squared(half: DVec3) -> DVec3 {
    DVec3::splat(half.length_squared()) - half * half
}

fn about_y(along: f64, across: f64) -> DVec3 {
    DVec3::new(across, along, across)
}

/// Principal moments of an inertia matrix, in no particular order.
pub(crate) fn principal_moments(inertia: DMat3) -> DVec3 {
    eigen(inertia).0
}

/// Eigenvalues λ of a symmetric matrix and a rotation V of eigenvectors, A = V diag(λ) Vᵀ.
///
/// Cyclic Jacobi method (Jacobi 1846; Golub & Van Loan, Matrix Computations, 4th ed., §8.5): the
/// plane rotation J that zeroes A_pq has t = tan θ with t² + 2 τ t − 1 = 0, τ = (A_qq − A_pp)/2A_pq;
/// of the two roots the smaller one. A ← Jᵀ A J, V ← V J, over all pairs until A is diagonal;
/// convergence is quadratic, six sweeps are plenty for f64.
fn eigen(matrix: DMat3) -> (DVec3, DMat3) {
    let (mut a, mut v) = (matrix, DMat3::IDENTITY);
    for _sweep in 0..10 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let j = jacobi_rotation(&a, p, q);
            a = j.transpose() * a * j;
            v *= j;
        }
    }
    (DVec3::new(a.col(0).x, a.col(1).y, a.col(2).z), v)
}

fn jacobi_rotation(a: &DMat3, p: usize, q: usize) -> DMat3 {
    let mut j = DMat3::IDENTITY;
    let a_pq = a.col(q)[p];
    if a_pq != 0.0 {
        let tau = (a.col(q)[q] - a.col(p)[p]) / (2.0 * a_pq);
        let t = tau.signum() / (tau.abs() + tau.hypot(1.0));
        let c = 1.0 / t.hypot(1.0);
        let s = t * c;
        j.col_mut(p)[p] = c;
        j.col_mut(q)[q] = c;
        j.col_mut(q)[p] = s;
        j.col_mut(p)[q] = -s;
    }
    j
}
