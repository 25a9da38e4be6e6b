//! What a step of a pile consists of, compiled.

use crate::Card;
use crate::joints::Joints;
use crate::plan;
use crate::report;
use crate::scene::Scene;
use crate::seen::seen;
use numbers::trace::Members;
use rigid::impulse::{ContactTables, row};
use sim::DeviceError;

/// What lies between the kernels. One text; each of its entry points sees some of the buffers that it binds, eight at most,
/// as a browser gives no more.
const TEXT: [&str; 10] = [
    include_str!("bindings.wgsl"),
    include_str!("bodies.wgsl"),
    include_str!("broad_phase.wgsl"),
    include_str!("narrow_phase.wgsl"),
    include_str!("meshes.wgsl"),
    include_str!("colours.wgsl"),
    include_str!("contacts.wgsl"),
    include_str!("blows.wgsl"),
    include_str!("parts.wgsl"),
    include_str!("joints.wgsl"),
];

/// The WGSL between the kernels, of so many worlds side by side: what all see, sums, and sorting; then, about the kernels
/// that tell, what these are given, and sums of what they tell.
pub fn texts(worlds: u32) -> [String; 5] {
    let own = plan::constants(worlds) + &TEXT.concat();
    let [scan, sort] = [include_str!("scan.wgsl"), include_str!("sort.wgsl")].map(String::from);
    let [given, told] = report::texts();
    [own, scan, sort, given, told]
}

/// Storage buffers that it binds, the last two to be read only; and the plan.
const BINDINGS: usize = 21;
const READ_ONLY: usize = 2;

macro_rules! entries {
    ($($name:ident,)+) => {
        /// The names of that text's entry points.
        pub(crate) const ENTRIES: [&str; [$(stringify!($name)),+].len()] = [$(stringify!($name)),+];
        /// The entry points of that text.
        #[derive(Debug)]
        pub(crate) struct Entries<C: Card> {
            $(pub $name: C::Kernel,)+
        }
        impl<C: Card> Entries<C> {
            fn new(card: &C, text: &str, layout: &C::Layout) -> Result<Self, DeviceError> {
                let [$($name),+] = card.entries(text, seen(text, ENTRIES), layout)?;
                Ok(Self { $($name,)+ })
            }
        }
    };
}

entries! {
    clear, load_bodies, load_shapes,
    surround, count_buckets, fill_buckets, count_pairs, list_pairs, plan_groups,
    seat_pairs, place_pairs, seat_meshes, part_pairs, find_touching, make_contacts, warm_contacts,
    join, paint, settle, plan_colours, seat_contacts, find_pressing,
    foresee_blows, begin_blows, keep_free, tell_blows, part_struck, end_round, put_free, read_contacts, check_bodies, check_shapes,
    store_bodies, store_contacts, end,
    load_joints, store_joints,
    find_ended, match_parts, seat_parts, read_parts, place_ended, merge,
}

/// All of it.
#[derive(Debug)]
pub(crate) struct Kernels<C: Card> {
    pub bindings: C::Layout,
    /// Words and a uniform; words, status, marks and a uniform.
    pub scanned: C::Layout,
    pub sorted: C::Layout,
    pub entries: Entries<C>,
    pub scan: [C::Kernel; 3],
    pub sort: [C::Kernel; 2],
    pub place: C::Kernel,
    pub push_body: C::Kernel,
    pub begin: C::Kernel,
    pub advance: C::Kernel,
    pub advance_again: C::Kernel,
    pub part: C::Kernel,
    pub drift: C::Kernel,
    pub finish: C::Kernel,
    pub prepare: C::Kernel,
    pub foresee: C::Kernel,
    pub warm_start: C::Kernel,
    pub strike_foreseen: C::Kernel,
    pub strike: C::Kernel,
    pub add_part: C::Kernel,
    pub push: C::Kernel,
    pub relax: C::Kernel,
    pub joints: Option<JointKernels<C>>,
    /// Of each group of pairs: which are apart, and where they touch.
    pub apart: Vec<Option<C::Kernel>>,
    pub groups: Vec<C::Kernel>,
}

/// What is done to joints.
#[derive(Debug)]
pub(crate) struct JointKernels<C: Card> {
    pub follow: C::Kernel,
    pub place: C::Kernel,
    pub warm_start: C::Kernel,
    pub strike: C::Kernel,
    pub push: C::Kernel,
    pub relax: C::Kernel,
}

impl<C: Card> JointKernels<C> {
    fn new(card: &C, joints: &Joints) -> Result<Self, DeviceError> {
        let kernel = |program| card.kernel(program, false, joints.members());
        let p = &joints.programs;
        Ok(Self {
            follow: kernel(&p.follow)?,
            place: kernel(&p.place)?,
            warm_start: kernel(&p.warm_start)?,
            strike: kernel(&p.strike)?,
            push: kernel(&p.push)?,
            relax: kernel(&p.relax)?,
        })
    }
}

impl<C: Card> Kernels<C> {
    pub fn new(card: &C, scene: &Scene) -> Result<Self, DeviceError> {
        let bindings = card.layout(BINDINGS - READ_ONLY, READ_ONLY);
        let (scanned, sorted) = (card.layout(1, 0), card.layout(2, 1));
        let [text, scan, sort, ..] = texts(scene.plan.worlds);
        let contact = Members::Seats {
            bodies: row::PREPARED as u32,
            state: ContactTables::new().length as u32,
        };
        let of_contact = |program| card.kernel(program, false, contact);
        let joint = |joints| JointKernels::new(card, joints);
        let of_run = |program| card.kernel(program, true, Members::Runs);
        let p = &scene.programs;
        let groups = scene.groups.iter();
        Ok(Self {
            entries: Entries::new(card, &text, &bindings)?,
            bindings,
            scan: card.entries(&scan, seen(&scan, ["groups", "sums", "add"]), &scanned)?,
            sort: card.entries(&sort, seen(&sort, ["count", "place"]), &sorted)?,
            place: card.kernel(&p.place, true, Members::Worlds)?,
            push_body: of_run(&p.push_body)?,
            begin: of_run(&p.begin)?,
            advance: of_run(&p.advance)?,
            advance_again: of_run(&p.advance_again)?,
            part: of_run(&p.part)?,
            drift: of_run(&p.drift)?,
            finish: of_run(&p.finish)?,
            prepare: of_contact(&p.prepare)?,
            foresee: of_contact(&p.foresee)?,
            warm_start: of_contact(&p.warm_start)?,
            strike_foreseen: of_contact(&p.strike_foreseen)?,
            strike: of_contact(&p.strike)?,
            add_part: of_contact(&p.add_part)?,
            push: of_contact(&p.push)?,
            relax: of_contact(&p.relax)?,
            joints: scene.joints.as_ref().map(joint).transpose()?,
            apart: groups
                .clone()
                .map(|group| group.apart.as_ref().map(of_run).transpose())
                .collect::<Result<_, _>>()?,
            groups: groups
                .map(|group| of_run(&group.program))
                .collect::<Result<_, _>>()?,
            scanned,
            sorted,
        })
    }
}
