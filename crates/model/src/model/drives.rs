//! Drives for models that have none, as those of robot files.

use crate::{Drive, JointId, JointKind, Model, ModelError};

impl Model {
    /// The same with a drive along each degree of freedom of some joints, in place of what they had.
    ///
    /// Where the drive's effort limit is infinite, each keeps its own, as URDF files have it.
    ///
    /// # Errors
    /// For joints that take no drive: free ones, and those that close a loop.
    ///
    /// # Panics
    /// If a joint is not of this model.
    pub fn with_drives(&self, drive: Drive, joints: &[JointId]) -> Result<Self, ModelError> {
        let mut parts = self.parts.clone();
        for &JointId(row) in joints {
            for dof in &mut parts.joints[row].dofs {
                let effort_limit = match drive.effort_limit {
                    f64::INFINITY => dof.drive.effort_limit,
                    given => given,
                };
                dof.drive = Drive {
                    effort_limit,
                    ..drive
                };
            }
        }
        Self::new(parts)
    }

    /// The joints that may have drives of their own: those with degrees of freedom, but for free ones, and those that
    /// follow another by a coupling.
    pub fn drivable_joints(&self) -> Vec<JointId> {
        let follows = |row| self.couplings.iter().any(|c| c.joint == JointId(row));
        let joints = self.joints.iter().enumerate();
        let drivable = joints.filter(|(row, joint)| {
            joint.degrees_of_freedom() > 0 && joint.kind != JointKind::Free && !follows(*row)
        });
        drivable.map(|(row, _)| JointId(row)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Builder, Coupling, Geometry};
    use glam::DVec3;

    /// A free body, a hinge with an effort limit, and a slide that follows it.
    fn robot() -> Model {
        let mut world = Builder::new("robot");
        let object = world.object("robot");
        let [base, arm, hand] = ["base", "arm", "hand"].map(|name| {
            let body = object.body(name).shape(Geometry::Sphere { radius: 0.1 });
            body.mass(1.0).handle()
        });
        object.free("base", base);
        let hinge = object.revolute("hinge", arm, DVec3::X).parent(base);
        hinge.dofs_mut()[0].drive.effort_limit = 5.0;
        object.prismatic("slide", hand, DVec3::X).parent(arm);
        let mut parts = world.build().unwrap().into_parts();
        parts.couplings.push(Coupling {
            name: "follow".into(),
            joint: JointId(2),
            other: JointId(1),
            ratio: 2.0,
            offset: 0.0,
        });
        Model::new(parts).unwrap()
    }

    #[test]
    fn drives_keep_the_limits_of_their_joints() {
        let model = robot();
        assert_eq!(model.drivable_joints(), [JointId(1)]);
        let drive = Drive {
            stiffness: 100.0,
            damping: 10.0,
            ..Drive::default()
        };
        let driven = model.with_drives(drive, &model.drivable_joints()).unwrap();
        let found = driven.joints[1].dofs[0].drive;
        assert_eq!((found.stiffness, found.effort_limit), (100.0, 5.0));
        let weaker = Drive {
            effort_limit: 3.0,
            ..drive
        };
        let driven = model.with_drives(weaker, &[JointId(1)]).unwrap();
        assert_eq!(driven.joints[1].dofs[0].drive.effort_limit, 3.0);
        assert_eq!(driven.joints[2], model.joints[2]);
        let told = model
            .with_drives(drive, &[JointId(0)])
            .unwrap_err()
            .to_string();
        assert!(told.contains("base"), "{told}");
    }
}
