//! The messages between an engine and a page.
//!
//! Both ways text messages are JSON objects with a field `type`; what changes with every frame goes from
//! the engine to the page as binary messages, see [`frame`](crate::frame). All units are SI, angles in
//! radians, quaternions x, y, z, w, colours sRGB from 0 to 1. Indices count from 0; −1 is the world.
//!
//! `web/src/protocol.ts` says the same in TypeScript; a test of each side reads the messages that
//! `web/tests/messages.json` holds.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Version of messages and frames; a page refuses any other.
pub const PROTOCOL: u32 = 1;

/// Values of a form by the names of its fields. A flag is 0 or 1, a choice the row of its name.
pub type Values = BTreeMap<String, f64>;

/// From the page to the engine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum Command {
    /// Opens an example, stopped at its initial state. Answered by [`Message::Scene`].
    Open {
        /// Name of the example.
        example: String,
        /// Values of its build parameters; its defaults where none are given.
        #[serde(default)]
        build: Values,
        /// Values of its physics; the example's own where none are given.
        #[serde(default)]
        physics: Values,
    },
    /// Opens a robot file, MJCF or URDF, stopped at its initial state. Answered by [`Message::Scene`], whose
    /// guide says what of the file was left out. Other files that it names are not there.
    File {
        /// Its name, for messages.
        name: String,
        /// What is in it.
        text: String,
    },
    /// Builds the present example again with other build parameters. Answered by [`Message::Scene`].
    Rebuild {
        /// Values of its build parameters; those not given stay.
        build: Values,
    },
    /// Changes physics parameters; the state stays where it can, else the example restarts with a new
    /// [`Message::Scene`].
    Physics {
        /// Values; those not given stay.
        values: Values,
    },
    /// Goes on stepping with the clock.
    Run {},
    /// Stops.
    Stop {},
    /// Stops, after so many time steps.
    Step {
        /// Number of steps, from 1 to 100,000.
        steps: u32,
    },
    /// The initial state, stopped; targets and parameters stay.
    Restart {},
    /// Simulated seconds a second of the clock.
    Speed {
        /// From 0.001 to 1000; none is as fast as the machine can.
        factor: Option<f64>,
    },
    /// Which worlds frames show, in this order.
    Show {
        /// At most 256.
        worlds: Vec<u32>,
    },
    /// Sets what drives one degree of freedom, in all worlds. What is not given stays.
    Joint {
        /// Which degree of freedom.
        dof: u32,
        /// Target position [m or rad].
        #[serde(default)]
        position: Option<f64>,
        /// Stiffness of the drive [N/m or N·m/rad].
        #[serde(default)]
        stiffness: Option<f64>,
        /// Target velocity [m/s or rad/s].
        #[serde(default)]
        velocity: Option<f64>,
        /// Damping of the drive [N·s/m or N·m·s/rad].
        #[serde(default)]
        damping: Option<f64>,
    },
    /// Sets one actuator's control, in all worlds.
    Control {
        /// Which actuator.
        actuator: u32,
        /// Its control, in the unit of its [`Slider`].
        value: f64,
    },
    /// Draws a point of a body to a point of the world with a damped spring, until released.
    Grab {
        /// Which world.
        world: u32,
        /// Which body.
        body: u32,
        /// The point in the body's frame [m].
        point: [f64; 3],
        /// Where to [m].
        to: [f64; 3],
    },
    /// Lets go of what was grabbed.
    Release {},
    /// A blow on a body, along a ray that the user aims.
    Push {
        /// Which world.
        world: u32,
        /// Which body.
        body: u32,
        /// Where, in the body's frame [m].
        point: [f64; 3],
        /// The impulse in world axes [N·s].
        impulse: [f64; 3],
    },
    /// Which quantities frames carry for plots, in this order.
    Plot {
        /// Rows of [`Scene::quantities`]; at most 16.
        quantities: Vec<u32>,
    },
    /// Returns to the recorded state nearest to a time, stopped.
    Scrub {
        /// Seconds since the start.
        time: f64,
    },
}

impl Command {
    /// Whether it sets what forms and sliders of all pages show.
    pub(crate) fn sets(&self) -> bool {
        matches!(
            self,
            Self::Physics { .. } | Self::Joint { .. } | Self::Control { .. }
        )
    }
}

/// From the engine to the page, as text.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Message {
    /// The first message.
    Welcome {
        /// [`PROTOCOL`].
        protocol: u32,
        /// What can be opened: nothing where a program owns the simulation.
        examples: Vec<Example>,
    },
    /// What is simulated from now on.
    Scene(Box<Scene>),
    /// How it goes; after every command, and a few times a second while it runs.
    Status(Status),
    /// Somebody else has set physics, drives or actuators: another page; the session, where a graphics card has
    /// failed; or the program, whose settings are told as the first world shown has them, a few times a second.
    Changed {
        /// What it said, or would have to say: [`Command::Physics`], [`Command::Joint`] and [`Command::Control`].
        commands: Vec<Command>,
    },
    /// A picture or a model that bodies may wear from now on.
    SkinFile(SkinFile),
    /// A program has dressed bodies: each page is told what is new to it. Those of another scene are to be dropped.
    Dress {
        /// As in [`Scene::id`].
        scene: u32,
        /// Who wears what from now on. What is not named stays.
        outfits: Vec<Outfit>,
        /// Files that will not be worn again without being told anew.
        forget: Vec<String>,
    },
    /// A command was refused, and all is as before it; or a step could not be made, and the session has stopped; or
    /// something else was done than what was asked for.
    Error {
        /// What is wrong, and the remedy.
        message: String,
        /// The `type` of the command that was refused, if one was.
        refused: Option<String>,
    },
}

/// A picture or a model that bodies may wear.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SkinFile {
    /// What [`Skin::File`] calls it.
    pub id: String,
    /// Its name, for messages.
    pub name: String,
    /// What it is.
    pub format: FileFormat,
    /// What is in it, in base64.
    pub data: String,
}

/// What a file of a skin is: a picture, but for `Glb`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FileFormat {
    /// PNG.
    Png,
    /// JPEG.
    Jpeg,
    /// WebP.
    Webp,
    /// A model.
    Glb,
}

/// What some bodies wear.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outfit {
    /// Rows of [`Scene::bodies`]; none are all of them, which then wear nothing of their own.
    pub bodies: Option<Vec<u32>>,
    /// What they wear.
    pub skin: Skin,
}

/// What a body wears.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Skin {
    /// The colours of its shapes.
    Plain {},
    /// One colour and opacity.
    Color {
        /// Red, green, blue, opacity.
        color: [f32; 4],
    },
    /// A colour for each replica.
    Replica {},
    /// A colour that follows its state.
    Gauge {
        /// Which measure of it.
        gauge: Gauge,
    },
    /// A picture on its shapes, or a model in their place.
    File {
        /// [`SkinFile::id`].
        file: String,
        /// Whether a model is fitted to the body's shapes; else it is as large as in its file.
        fitted: bool,
    },
}

/// Measures of a body's state that a skin may show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Gauge {
    /// Of its frame's origin [m/s].
    Speed,
    /// How fast it turns [rad/s].
    Spin,
    /// Sum of the magnitudes of its contact forces [N].
    Force,
    /// Of its frame's origin, along the axis that points up [m].
    Height,
}

/// An example of the gallery.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Example {
    /// Name, as a word.
    pub name: String,
    /// Name for people.
    pub title: String,
    /// What there is to see, in a line.
    pub about: String,
    /// Two or three sentences: what to try, and what to observe.
    pub guide: String,
    /// What it can be built with.
    pub build: Vec<Field>,
}

/// A field of a form.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Field {
    /// Name in [`Values`].
    pub name: String,
    /// Name for people.
    pub label: String,
    /// Unit; empty for a bare number.
    pub unit: String,
    /// What it does, in a sentence.
    pub help: String,
    /// What is to be known of it now, such as why something cannot be chosen.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
    /// What values it takes.
    pub kind: FieldKind,
    /// Its value now, or at first.
    pub value: f64,
}

/// What values a field takes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum FieldKind {
    /// Any number in a range.
    Number {
        /// Least.
        min: f64,
        /// Most.
        max: f64,
        /// Whether a slider of it is better logarithmic.
        logarithmic: bool,
    },
    /// A whole number in a range.
    Integer {
        /// Least.
        min: f64,
        /// Most.
        max: f64,
    },
    /// 0 or 1.
    Flag,
    /// One of several, by its row.
    Choice {
        /// Their names for people.
        names: Vec<String>,
    },
}

/// All of a model that a page shows. See [`Placement`] for frames.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// Counts the scenes of a session; frames of another scene are to be dropped.
    pub id: u32,
    /// Name of the example, or of the file.
    pub name: String,
    /// Name for people.
    pub title: String,
    /// As in [`Example`].
    pub guide: String,
    /// The axis that points up: `y` or `z`.
    pub up: char,
    /// Time step [s].
    pub time_step: f64,
    /// Number of worlds.
    pub worlds: u32,
    /// Solver that runs.
    pub solver: String,
    /// Instruction set that runs.
    pub isa: String,
    /// What it was built with.
    pub build: Vec<Field>,
    /// How it is simulated; empty where a program owns the simulation, where neither can stiffness and damping
    /// of drives be changed.
    pub physics: Vec<Field>,
    /// Bodies, in the order of the frames.
    pub bodies: Vec<Body>,
    /// Shapes.
    pub shapes: Vec<Shape>,
    /// Joints.
    pub joints: Vec<Joint>,
    /// Actuators.
    pub actuators: Vec<Actuator>,
    /// Cameras that see for a robot.
    pub cameras: Vec<Camera>,
    /// Lights that the model names; where there are none, it is day.
    pub lamps: Vec<Lamp>,
    /// Which of them is the sun, or −1.
    pub sun: i32,
    /// What can be plotted.
    pub quantities: Vec<Quantity>,
    /// What is left out of them, in a sentence, if anything is.
    pub unlisted: Option<String>,
    /// The rows of `quantities` that the example plots at first.
    pub plots: Vec<u32>,
    /// Worlds shown at first.
    pub shown: Vec<u32>,
    /// Distance [m] from world to world where several are shown side by side.
    pub spacing: f64,
    /// A box that holds the bodies as they stand in the model: two corners [m].
    pub bounds: [[f64; 3]; 2],
}

/// A position [m] and an orientation, in the frame of the body that is named beside, or of the world.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Placement {
    /// Position [m].
    pub position: [f64; 3],
    /// Quaternion x, y, z, w.
    pub orientation: [f64; 4],
}

/// A body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Body {
    /// Name.
    pub name: String,
    /// Whether it can move.
    pub dynamic: bool,
    /// Mass [kg].
    pub mass: f64,
    /// Centre of mass, and principal axes.
    pub inertial: Placement,
    /// Principal moments of inertia [kg·m²].
    pub inertia: [f64; 3],
    /// The joint that carries it, or −1.
    pub joint: i32,
    /// Its default colour and opacity.
    pub color: [f32; 4],
}

/// A shape.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// Name; may be empty.
    pub name: String,
    /// Owner, or −1 for the world.
    pub body: i32,
    /// Where it is in its owner's frame.
    pub placement: Placement,
    /// What it is.
    pub geometry: Geometry,
    /// Whether it takes part in contacts.
    pub collides: bool,
    /// Whether it touches without pushing.
    pub sensor: bool,
    /// Colour and opacity; the owner's where there is none.
    pub color: Option<[f32; 4]>,
}

/// Forms of shapes, in their own frames; capsules, cylinders and cones stand along y.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Geometry {
    /// A plane with the normal +y.
    Plane {
        /// Half extents along x and z [m]; none where it has no end.
        half: Option<[f64; 2]>,
    },
    /// A ball.
    Sphere {
        /// Radius [m].
        radius: f64,
    },
    /// A cylinder with round ends.
    Capsule {
        /// Radius [m].
        radius: f64,
        /// Half height with the ends [m].
        half_height: f64,
    },
    /// A cylinder.
    Cylinder {
        /// Radius [m].
        radius: f64,
        /// Half height [m].
        half_height: f64,
    },
    /// A cone, its apex at +y.
    Cone {
        /// Radius of the base [m].
        radius: f64,
        /// Half height [m].
        half_height: f64,
    },
    /// A cuboid.
    Box {
        /// Half extents [m].
        half: [f64; 3],
    },
    /// An ellipsoid.
    Ellipsoid {
        /// Half axes [m].
        half: [f64; 3],
    },
    /// Triangles: a hull, a mesh, a height field.
    Mesh {
        /// Corners [m], three numbers each.
        positions: Vec<f32>,
        /// Corners of triangles, three each, counter-clockwise from the front.
        triangles: Vec<u32>,
        /// Whether edges show: true for hulls.
        flat: bool,
    },
}

/// A joint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Joint {
    /// Name.
    pub name: String,
    /// `revolute`, `prismatic`, `ball`, `fixed`, `free`, `distance`, `d6`, `plane_xz`.
    pub kind: String,
    /// Parent body, or −1.
    pub parent: i32,
    /// Child body.
    pub child: i32,
    /// Its frame in the parent.
    pub parent_frame: Placement,
    /// Its frame in the child.
    pub child_frame: Placement,
    /// Its degrees of freedom.
    pub dofs: Vec<Dof>,
    /// Its first row among the joint coordinates of a frame, which has `coordinates` of them; −1 where it
    /// closes a loop.
    pub coordinate: i32,
    /// Number of its coordinates: 4 of a ball, 7 of a free joint, else one for each degree of freedom.
    pub coordinates: u32,
}

/// A degree of freedom.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Dof {
    /// Name.
    pub name: String,
    /// Row in [`Command::Joint`].
    pub dof: u32,
    /// Whether it turns (radians) or slides (metres).
    pub angular: bool,
    /// Unit axis in the joint's frame.
    pub axis: [f64; 3],
    /// A point [m] on the axis in the joint's frame.
    pub point: [f64; 3],
    /// Least and most coordinate [m or rad], if it has limits.
    pub limit: Option<[f64; 2]>,
    /// Target position now [m or rad].
    pub position: f64,
    /// Stiffness of the drive now [N/m or N·m/rad].
    pub stiffness: f64,
    /// Target velocity now [m/s or rad/s].
    pub velocity: f64,
    /// Damping of the drive now [N·s/m or N·m·s/rad].
    pub damping: f64,
    /// Whether the example wants sliders for its drive at first.
    pub sliders: bool,
    /// Sliders of its drive, named as the fields of [`Command::Joint`]; none where it cannot have one.
    pub drive: Vec<Slider>,
}

/// What a slider sets, and how far it goes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Slider {
    /// The field of its command.
    pub name: String,
    /// Name for people.
    pub label: String,
    /// Unit; empty for a bare number.
    pub unit: String,
    /// What it does, in a sentence.
    pub help: String,
    /// Least.
    pub min: f64,
    /// Most.
    pub max: f64,
    /// Whether it is better logarithmic.
    pub logarithmic: bool,
    /// Whether what is beyond is refused.
    pub strict: bool,
}

/// An actuator.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Actuator {
    /// Name.
    pub name: String,
    /// Control now.
    pub value: f64,
    /// The slider of its control.
    pub slider: Slider,
}

/// A camera that looks along its −z, with +y up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// Name.
    pub name: String,
    /// Body that carries it, or −1.
    pub body: i32,
    /// Whether it turns with its body, or only goes along with its origin.
    pub mode: model::CameraMode,
    /// Where it is: in that body's frame, or from its origin along world axes.
    pub placement: Placement,
    /// Vertical field of view [rad].
    pub field_of_view: f64,
}

/// A light that shines along its −z.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lamp {
    /// Name.
    pub name: String,
    /// Body that carries it, or −1.
    pub body: i32,
    /// Whether it turns with its body, or only goes along with its origin.
    pub mode: model::CameraMode,
    /// Where it is: in that body's frame, or from its origin along world axes.
    pub placement: Placement,
    /// Where its light goes.
    pub beam: Beam,
    /// What it adds to a white sheet that faces it, before it fades, in linear light.
    pub color: [f32; 3],
    /// a, b and c by which it fades with the distance d [m] as 1 / (a + b d + c d²).
    pub attenuation: [f64; 3],
    /// Whether it throws shadows.
    pub shadows: bool,
}

/// Where the light of a lamp goes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Beam {
    /// Everywhere in one direction.
    Parallel,
    /// From a point in all directions.
    Point,
    /// From a point, as cosᵉ of the angle to the axis.
    Spot {
        /// The largest angle [rad].
        cutoff: f64,
        /// The exponent e.
        exponent: f64,
    },
}

/// A number that changes with time, of the first world shown.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quantity {
    /// Name for people.
    pub label: String,
    /// Unit.
    pub unit: String,
    /// What it belongs to: `energy`, `momentum`, `contact`, `joint`, `body`.
    pub group: String,
}

/// How it goes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Status {
    /// Whether it goes on by itself, or has steps to make.
    pub running: bool,
    /// Name of the graphics card that it runs on, if it is not the processor.
    pub card: Option<String>,
    /// Simulated seconds since the start; of a program's worlds, in the first shown that has not diverged.
    pub time: f64,
    /// Steps since the start, likewise.
    pub steps: u64,
    /// As in [`Command::Speed`].
    pub speed: Option<f64>,
    /// Simulated seconds a second of the clock, of late; 0 where it is stopped.
    pub pace: f64,
    /// World-steps a second of computing, of late.
    pub rate: f64,
    /// Worlds that diverged and stand still.
    pub diverged: Vec<u32>,
    /// Worlds that frames show, in this order: any page may have chosen them.
    pub shown: Vec<u32>,
    /// Rows of [`Scene::quantities`] that frames carry, in this order.
    pub plots: Vec<u32>,
    /// First and last time [s] to which [`Command::Scrub`] can return.
    pub recorded: [f64; 2],
}
