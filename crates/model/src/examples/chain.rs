//! Chains of rods: pendula of many links.

use super::countable;
use crate::{Builder, Geometry, Model, ModelError, Pose};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// Length of a chain, from its hanging point to its tip [m].
pub const CHAIN_LENGTH: f64 = 3.0;
/// Mass of each link of a chain [kg].
pub const CHAIN_LINK_MASS: f64 = 1.0;

/// How a chain starts: straight, pointing …
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// … down.
    Hanging,
    /// … along x.
    Horizontal,
    /// … up.
    Upright,
}

/// A pendulum of that many links, started horizontal; see [`chain`].
///
/// # Errors
/// If there are no links, or more than a million.
pub fn n_pendula(links: usize) -> Result<Model, ModelError> {
    chain(links, Start::Horizontal)
}

/// A planar chain of equal rods (capsules with a twentieth of their length as radius) on hinges
/// about z, hung from the world's origin.
///
/// Y is up. All hinges are at zero when the chain hangs straight down; the first one's initial
/// angle makes the start. The frame of a link is at its centre, y pointing to the hinge before it.
/// Links touch nothing.
///
/// # Errors
/// If there are no links, or more than a million.
pub fn chain(links: usize, start: Start) -> Result<Model, ModelError> {
    countable("chain", "number of links", links)?;
    let length = CHAIN_LENGTH / links as f64;
    let rod = Geometry::Capsule {
        radius: length / 20.0,
        half_height: length / 2.0,
    };
    let to_hinge = Pose::at(DVec3::new(0.0, length / 2.0, 0.0));
    let mut world = Builder::new(format!("chain_{links}"));
    let pendulum = world.object("pendulum");
    let mut parent = None;
    for i in 0..links {
        let link = pendulum
            .body(format!("link{i}"))
            .shape(rod.clone())
            .mass(CHAIN_LINK_MASS)
            .group(0)
            .handle();
        let hinge = pendulum.revolute(format!("hinge{i}"), link, DVec3::Z);
        match parent {
            None => hinge
                .frames(Pose::IDENTITY, to_hinge)
                .initial(&[start.angle()]),
            Some(body) => hinge.parent(body).frames(to_hinge.inverse(), to_hinge),
        };
        parent = Some(link);
    }
    world.build()
}

impl Start {
    /// Angle of the first hinge [rad].
    fn angle(self) -> f64 {
        match self {
            Self::Hanging => 0.0,
            Self::Horizontal => FRAC_PI_2,
            Self::Upright => PI,
        }
    }
}
