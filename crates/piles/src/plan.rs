//! How many things of each kind there are, and where their words lie; and the same as text, for the shader.

use crate::constants::SURFACE;
use crate::joints;
use crate::meshes::ROW;
use crate::scene::{PLACES, SIDE, UNIT};
use bytemuck::{Pod, Zeroable};
use collide::mesh::{BEYOND, BOUNDS, NUMBER, SLOTS, TRIANGLE};
use rigid::impulse::blow::ROUNDS as BLOWS;
use rigid::impulse::joint::{ROWS, acting, bounded};
use rigid::impulse::pair::{FAR, MARGIN, ONE, placed, point_place, solid};
use rigid::impulse::{
    ContactTables, NEARBY, POINTS, REMEMBERED, SAME_NORMAL, SAME_PLACE, contact, manifold, point,
    remembered, row, state,
};

macro_rules! plan {
    ($($name:ident: $kind:ty,)+) => {
        /// See `bindings.wgsl`, which has the same fields.
        #[repr(C)]
        #[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
        pub(crate) struct Plan {
            $(pub $name: $kind,)+
        }
    };
}

plan! {
    worlds: u32, bodies: u32, shapes: u32, units: u32, joints: u32,
    own_bodies: u32, own_shapes: u32, own_units: u32, own_joints: u32,
    large: u32, forms: u32, groups: u32, solid_groups: u32, surfaces: u32,
    pairs: u32, mesh_pairs: u32, most_near: u32, contacts: u32, remembered: u32, joint_runs: u32, law_numbers: u32, small_steps: u32,
    buckets: u32, pair_blocks: u32, contact_blocks: u32,
    state_numbers: u32, body_state: u32, count: u32, memory: u32, forgotten: u32, tied: u32,
    forces: u32, given: u32, given_numbers: u32, acting: u32,
    cells: u32, bucket_of: u32, bucket_start: u32, bucket_items: u32, unit_start: u32,
    pair_shapes: u32, pair_group: u32, pair_order: u32, pair_place: u32, group_matrix: u32,
    contact_start: u32, body_start: u32, body_items: u32,
    colour: u32, colour_matrix: u32, contact_order: u32,
    pressing: u32, foreseen: u32, near: u32, ended: u32, merged: u32, same: u32,
    carriers: u32, sides: u32, apart_start: u32, apart_items: u32, shape_form: u32, form_group: u32,
    group_places: u32, unit_shapes: u32, large_shapes: u32, shape_surface: u32, first_corner: u32,
    ties: u32, joint_seats: u32, joint_run: u32, paired_start: u32, paired_items: u32,
    mesh_of_shape: u32, mesh_group_rows: u32, mesh_cluster_rows: u32,
    mesh_groups: u32, mesh_clusters: u32, mesh_triangles: u32,
    own_constants: u32, grown: u32, solids: u32, corners: u32, surface: u32, turn: u32,
    cell: f32, fastest: f32, farthest: f32,
}

/// Things that are sorted together.
pub(crate) const BLOCK: u32 = 256;
/// Most groups of pairs, by which these are sorted.
pub(crate) const GROUPS: u32 = BLOCK;
/// Colours of contacts, and the keys by which they are sorted: one more for those that find no colour, and one for those of
/// sensors, which are not solved.
pub(crate) const COLOURS: u32 = 64;
pub(crate) const KEYS: u32 = COLOURS + 2;

/// Contacts of the part before that give what they gave to one contact, at most: as many as a pair has of one normal.
pub(crate) const SUM_ROUNDS: u32 = SLOTS.div_ceil(POINTS) as u32;

/// Places in the status.
pub(crate) mod status {
    pub const FLAG: usize = 0;
    pub const PAIRS: usize = 1;
    pub const MESH_PAIRS: usize = 2;
    pub const CONTACTS: usize = 3;
    pub const COLOURED: usize = 4;
    pub const CHANGED: usize = 5;
    pub const SETTLED: usize = 6;
    pub const ROUND: usize = 7;
    pub const ROUNDS: usize = 8;
    /// Whether any contact may be struck in the step, whether any was in the round of blows, which round it is, and
    /// whether there is another one.
    pub const MEETING: usize = 9;
    pub const ANY_STRUCK: usize = 10;
    pub const BLOW_ROUND: usize = 11;
    pub const BLOWING: usize = 12;
    /// Most rounds in which anything was struck.
    pub const MOST_BLOWS: usize = 13;
    /// Told by the host: whether colours are those of the attempt before at the first step, how many rounds of blows and
    /// how many colours it launches.
    pub const KEEP: usize = 14;
    pub const ROUNDS_OF_BLOWS: usize = 15;
    pub const LAUNCHED: usize = 16;
    /// Into how many parts the host cuts the step, and which one it is, counted from 1.
    pub const PARTS: usize = 17;
    pub const PART: usize = 18;
    /// Contacts of the parts before that are none any more, and rounds in which those that are got what they gave.
    pub const ENDED: usize = 19;
    pub const SUM_ROUND: usize = 20;
    /// Whether a blow was foreseen in any of the steps.
    pub const FORESEEN: usize = 21;
    pub const WIDTH: usize = 22;
}

/// Places in what is told of each world, behind the status of all of them.
pub(crate) mod of_world {
    /// Why it was left out of a step, and of those that follow.
    pub const STOPPED: usize = 0;
    /// Steps that it has yet to take.
    pub const LEFT: usize = 1;
    /// Into how many parts its step has to be cut, and the largest turn of all its bodies in the step, in parts of what
    /// each is allowed.
    pub const NEEDED: usize = 2;
    pub const TURNED: usize = 3;
    /// How far the largest box about a shape reaches from its middle [m].
    pub const WIDEST: usize = 4;
    /// Whether any contact may be struck in the step, and in which round of blows any was last.
    pub const MEETS: usize = 5;
    pub const STRUCK: usize = 6;
    pub const WIDTH: usize = 7;
}

/// Why a step was not taken in any world.
pub(crate) mod flag {
    pub const MORE_PAIRS: u32 = 1;
    pub const MORE_CONTACTS: u32 = 2;
    pub const MORE_COLOURS: u32 = 4;
    pub const MORE_ROUNDS: u32 = 8;
    pub const MORE_BLOWS: u32 = 16;
    pub const MORE_MESH_PAIRS: u32 = 32;
    /// For these there has to be more room.
    pub const MORE_ROOM: u32 = MORE_PAIRS | MORE_MESH_PAIRS | MORE_CONTACTS;
}

/// Why a world was left out.
pub(crate) mod stopped {
    /// It has no step to take.
    pub const DONE: u32 = 1;
    /// The step is the processor's.
    pub const PROCESSOR: u32 = 2;
    /// The step has to be cut into other parts.
    pub const OTHER_PARTS: u32 = 4;
}

/// Places of runs: groups of pairs, colours, all contacts, all bodies.
pub(crate) mod run {
    pub const COLOURS: u32 = super::GROUPS;
    pub const CONTACTS: u32 = COLOURS + super::COLOURS;
    pub const BODIES: u32 = CONTACTS + 1;
    /// All contacts that are found, those of sensors, too.
    pub const SUMS: u32 = BODIES + 1;
    pub const COUNT: u32 = SUMS + 1;
    /// Launches of others: of colours and bodies where there are blows, and of the runs of joints.
    pub const BLOW_COLOURS: u32 = COUNT;
    pub const BLOW_BODIES: u32 = BLOW_COLOURS + super::COLOURS;
    pub const JOINTS: u32 = BLOW_BODIES + 1;
}

/// Where so much begins, if it comes next.
fn taken(end: &mut u32, length: u32) -> u32 {
    let at = *end;
    *end += length;
    at
}

impl Plan {
    /// Words and marks that steps need, once it is known for how many things there is room.
    pub fn place(&mut self) -> [u32; 2] {
        let mut end = 0;
        let mut take = |length: u32| taken(&mut end, length);
        self.buckets = (2 * self.shapes).next_power_of_two();
        self.pair_blocks = self.pairs.div_ceil(BLOCK);
        self.contact_blocks = self.contacts.div_ceil(BLOCK);
        let matrices = [self.group_matrix_length(), self.colour_matrix_length()];
        self.cells = take(3 * self.shapes);
        self.bucket_of = take(self.shapes);
        self.bucket_items = take(self.shapes);
        self.unit_start = take(self.units + 1);
        self.pair_shapes = take(2 * self.pairs);
        self.pair_order = take(self.pairs);
        self.pair_place = take(self.pairs);
        self.group_matrix = take(matrices[0]);
        self.contact_start = take(self.pairs + 1);
        self.body_items = take(2 * self.contacts);
        self.colour_matrix = take(matrices[1]);
        self.contact_order = take(self.contacts);
        self.pressing = take(self.contacts + 1);
        self.foreseen = take(self.contacts);
        self.near = take(2 * self.most_near * self.mesh_pairs);
        self.ended = take(self.places() + 1);
        self.merged = take(self.contacts);
        self.same = take(self.contacts);
        let mut marks = 0;
        let mut take = |length: u32| taken(&mut marks, length);
        self.bucket_start = take(self.buckets + 1);
        self.pair_group = take(self.pairs);
        self.body_start = take(self.bodies + 1);
        self.colour = take(self.contacts);
        [end, marks]
    }
    /// The same of so many worlds.
    pub fn of_worlds(self, worlds: u32) -> Self {
        let forces = worlds * self.state_numbers;
        let given = forces + 6 * worlds * self.own_bodies;
        Self {
            worlds,
            bodies: worlds * (1 + self.own_bodies),
            shapes: worlds * self.own_shapes,
            units: worlds * self.own_units,
            joints: worlds * self.own_joints,
            forces,
            given,
            acting: given + worlds * self.given_numbers,
            ..self
        }
    }
    /// The same with constants that lie elsewhere.
    pub fn with_constants_of(self, other: &Self) -> Self {
        Self {
            surfaces: other.surfaces,
            own_constants: other.own_constants,
            grown: other.grown,
            solids: other.solids,
            corners: other.corners,
            surface: other.surface,
            turn: other.turn,
            ..self
        }
    }
    /// Numbers of all states, of what acts on bodies, of joints' constants, and of what acts along their axes.
    pub fn numbers(&self) -> u32 {
        let laws = self.law_numbers / bounded::WIDTH as u32;
        self.acting + self.joints * ((ROWS * acting::WIDTH) as u32 + laws)
    }
    /// Of the largest launch.
    pub fn most_invocations(&self) -> u32 {
        let things = [self.bodies, self.shapes, self.units, self.buckets];
        let found = [self.pairs, self.contacts, self.places(), self.joints];
        let all = things.into_iter().chain(found);
        all.max().map_or(0, |most| most.saturating_add(1))
    }
    /// Of contacts that all worlds have room to remember.
    pub fn places(&self) -> u32 {
        self.worlds * self.remembered
    }
    pub fn group_matrix_length(&self) -> u32 {
        self.groups * self.pair_blocks
    }
    pub fn colour_matrix_length(&self) -> u32 {
        KEYS * self.contact_blocks
    }
}

/// What the shader has as constants, for so many worlds.
pub(crate) fn constants(worlds: u32) -> String {
    let t = ContactTables::new();
    let whole = [
        ("FLAG", status::FLAG),
        ("PAIRS", status::PAIRS),
        ("MESH_PAIRS", status::MESH_PAIRS),
        ("CONTACTS", status::CONTACTS),
        ("COLOURED", status::COLOURED),
        ("CHANGED", status::CHANGED),
        ("SETTLED", status::SETTLED),
        ("ROUND", status::ROUND),
        ("ROUNDS", status::ROUNDS),
        ("MEETING", status::MEETING),
        ("ANY_STRUCK", status::ANY_STRUCK),
        ("BLOW_ROUND", status::BLOW_ROUND),
        ("BLOWING", status::BLOWING),
        ("MOST_BLOWS", status::MOST_BLOWS),
        ("KEEP", status::KEEP),
        ("ROUNDS_OF_BLOWS", status::ROUNDS_OF_BLOWS),
        ("LAUNCHED", status::LAUNCHED),
        ("PARTS", status::PARTS),
        ("PART", status::PART),
        ("ENDED", status::ENDED),
        ("SUM_ROUND", status::SUM_ROUND),
        ("FORESEEN", status::FORESEEN),
        ("STATUS", status::WIDTH),
        ("STOPPED", of_world::STOPPED),
        ("LEFT", of_world::LEFT),
        ("NEEDED", of_world::NEEDED),
        ("TURNED", of_world::TURNED),
        ("WIDEST", of_world::WIDEST),
        ("MEETS", of_world::MEETS),
        ("STRUCK", of_world::STRUCK),
        ("OF_WORLD", of_world::WIDTH),
        ("MOST_ROUNDS_OF_BLOWS", BLOWS),
        ("MORE_PAIRS", flag::MORE_PAIRS as usize),
        ("MORE_MESH_PAIRS", flag::MORE_MESH_PAIRS as usize),
        ("MORE_CONTACTS", flag::MORE_CONTACTS as usize),
        ("MORE_COLOURS", flag::MORE_COLOURS as usize),
        ("MORE_ROUNDS", flag::MORE_ROUNDS as usize),
        ("MORE_BLOWS", flag::MORE_BLOWS as usize),
        ("DONE", stopped::DONE as usize),
        ("PROCESSOR", stopped::PROCESSOR as usize),
        ("OTHER_PARTS", stopped::OTHER_PARTS as usize),
        ("COLOUR_RUN", run::COLOURS as usize),
        ("CONTACTS_RUN", run::CONTACTS as usize),
        ("BODIES_RUN", run::BODIES as usize),
        ("SUMS_RUN", run::SUMS as usize),
        ("SUM_ROUNDS", SUM_ROUNDS as usize),
        ("BLOW_COLOUR_RUN", run::BLOW_COLOURS as usize),
        ("BLOW_BODIES_RUN", run::BLOW_BODIES as usize),
        ("JOINT_RUN", run::JOINTS as usize),
        ("COLOURS", COLOURS as usize),
        ("SENSED", KEYS as usize - 1),
        ("PLACES", PLACES),
        ("UNIT", UNIT),
        ("SIDE", SIDE),
        ("ROW", row::WIDTH),
        ("VELOCITY", row::VELOCITY),
        ("FREE", row::FREE),
        ("SHIFT", row::SHIFT),
        ("TURN", row::TURN),
        ("CENTER", row::CENTER),
        ("ORIENTATION", row::ORIENTATION),
        ("ACCELERATION", row::ACCELERATION),
        ("WRENCH", row::WRENCH),
        ("STATE", state::WIDTH),
        ("STATE_VELOCITY", state::VELOCITY),
        ("STATE_BEFORE", state::BEFORE),
        ("STATE_REST", state::REST),
        ("TRIANGLE", TRIANGLE),
        ("TRIANGLE_NUMBER", NUMBER),
        ("TRIANGLE_ROW", ROW),
        ("BOUNDS", BOUNDS),
        ("SLOTS", SLOTS),
        ("SOLID", solid::WIDTH),
        ("SOLID_SIZE", solid::SIZE),
        ("SOLID_EXTENT", solid::EXTENT),
        ("SOLID_RADIUS", solid::RADIUS),
        ("SOLID_THICKNESS", solid::THICKNESS),
        ("PLACED", placed::WIDTH),
        ("PLACED_POSITION", placed::POSITION),
        ("PLACED_ORIENTATION", placed::ORIENTATION),
        ("PLACED_WAY", placed::WAY),
        ("PLACED_EXTENT", placed::EXTENT),
        ("PAIR_PLACED", placed::REACH + 1),
        ("POINT_PLACE", point_place::WIDTH),
        ("POINT_PLACE_POSITION", point_place::POSITION),
        ("POINT_PLACE_NORMAL", point_place::NORMAL),
        ("POINT_PLACE_DISTANCE", point_place::DISTANCE),
        ("POINT_PLACE_FEATURE", point_place::FEATURE),
        ("REMEMBERED", REMEMBERED),
        ("REMEMBERED_SHAPES", remembered::SHAPES),
        ("REMEMBERED_POINTS", remembered::POINTS),
        ("REMEMBERED_NORMAL", remembered::NORMAL),
        ("REMEMBERED_DRAG", remembered::DRAG),
        ("REMEMBERED_TWIST", remembered::TWIST),
        ("REMEMBERED_DRAG_SUM", remembered::DRAG_SUM),
        ("REMEMBERED_TWIST_SUM", remembered::TWIST_SUM),
        ("REMEMBERED_POINT", remembered::POINT),
        ("REMEMBERED_POINT_WIDTH", remembered::POINT_WIDTH),
        ("MANIFOLD", t.point.at(0, 0)),
        ("MANIFOLD_NORMAL", manifold::NORMAL),
        ("MANIFOLD_FRICTION", manifold::FRICTION),
        ("MANIFOLD_RESTITUTION", manifold::RESTITUTION),
        ("MANIFOLD_STICKING", manifold::STICKING),
        ("MANIFOLD_THICKNESS", manifold::THICKNESS),
        ("MANIFOLD_DRAG", manifold::DRAG),
        ("MANIFOLD_TWIST", manifold::TWIST),
        ("MANIFOLD_DRAG_SUM", manifold::DRAG_SUM),
        ("MANIFOLD_TWIST_SUM", manifold::TWIST_SUM),
        ("MANIFOLD_ASIDE", manifold::ASIDE),
        ("MANIFOLD_STRUCK", manifold::STRUCK),
        ("POINT", point::WIDTH),
        ("POINT_ARM_A", point::ARM_A),
        ("POINT_GAP", point::GAP),
        ("POINT_IMPULSE", point::IMPULSE),
        ("POINT_SUM", point::SUM),
        ("POINTS", POINTS),
        ("SURFACE", SURFACE),
    ];
    let real = [
        ("FAR", FAR),
        ("NOWHERE", contact::NOWHERE),
        ("SAME_PLACE", SAME_PLACE),
        ("NEARBY", NEARBY),
        ("MARGIN", MARGIN),
        ("ONE", ONE),
        ("SAME_NORMAL", SAME_NORMAL),
        ("BEYOND", BEYOND),
    ];
    let whole = whole.into_iter().chain(joints::constants());
    let whole = whole.map(|(name, n)| format!("const {name}: u32 = {n}u;\n"));
    let real = real.map(|(name, x)| format!("const {name}: f32 = {x:e}f;\n"));
    let several = format!("const SEVERAL: bool = {};\n", worlds > 1);
    whole.chain(real).chain([several]).collect()
}
