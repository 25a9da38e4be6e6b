//! What a step of a pile consists of, compiled.

use super::joints::Joints;
use super::plan;
use super::scene::Scene;
use crate::pipeline::bind_group_layout;
use crate::{Gpu, GpuError};
use numbers::trace::Members;
use rigid::impulse::{ContactTables, row};
use wgpu::{BindGroupLayout, ComputePipeline};

/// What lies between the kernels. One text, since all see the same buffers.
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

/// Storage buffers that it binds, the last two to be read only; and the plan.
pub(super) const BINDINGS: usize = 21;
const READ_ONLY: usize = 2;

macro_rules! entries {
    ($($name:ident,)+) => {
        /// The entry points of that text.
        #[derive(Debug)]
        pub(super) struct Entries {
            $(pub $name: ComputePipeline,)+
        }
        impl Entries {
            fn new(gpu: &Gpu, text: &str, bindings: &BindGroupLayout) -> Result<Self, GpuError> {
                let names = [$(stringify!($name)),+];
                let [$($name),+] = gpu.entries(text, names, Some(bindings))?;
                Ok(Self { $($name,)+ })
            }
        }
    };
}

entries! {
    clear, load_bodies, load_shapes,
    surround, count_buckets, fill_buckets, count_pairs, list_pairs, plan_groups,
    seat_pairs, seat_meshes, part_pairs, find_touching, make_contacts,
    join, paint, settle, plan_colours, seat_contacts, find_pressing,
    foresee_blows, begin_blows, keep_free, tell_blows, part_struck, end_round, put_free, read_contacts, check_bodies, check_shapes,
    store_bodies, store_contacts, end,
    load_joints, store_joints,
    find_ended, match_parts, seat_parts, read_parts, place_ended, merge,
}

/// All of it.
#[derive(Debug)]
pub(super) struct Kernels {
    pub bindings: BindGroupLayout,
    /// Words and a uniform; words, status, marks and a uniform.
    pub scanned: BindGroupLayout,
    pub sorted: BindGroupLayout,
    pub entries: Entries,
    pub scan: [ComputePipeline; 3],
    pub sort: [ComputePipeline; 2],
    pub place: ComputePipeline,
    pub push_body: ComputePipeline,
    pub begin: ComputePipeline,
    pub advance: ComputePipeline,
    pub advance_again: ComputePipeline,
    pub part: ComputePipeline,
    pub drift: ComputePipeline,
    pub finish: ComputePipeline,
    pub prepare: ComputePipeline,
    pub foresee: ComputePipeline,
    pub warm_start: ComputePipeline,
    pub strike_foreseen: ComputePipeline,
    pub strike: ComputePipeline,
    pub add_part: ComputePipeline,
    pub push: ComputePipeline,
    pub relax: ComputePipeline,
    pub joints: Option<JointKernels>,
    /// Of each group of pairs: which are apart, and where they touch.
    pub apart: Vec<Option<ComputePipeline>>,
    pub groups: Vec<ComputePipeline>,
}

/// What is done to joints.
#[derive(Debug)]
pub(super) struct JointKernels {
    pub follow: ComputePipeline,
    pub place: ComputePipeline,
    pub measure: ComputePipeline,
    pub warm_start: ComputePipeline,
    pub strike: ComputePipeline,
    pub push: ComputePipeline,
    pub relax: ComputePipeline,
}

impl JointKernels {
    fn new(gpu: &Gpu, joints: &Joints) -> Result<Self, GpuError> {
        let kernel = |program| gpu.kernel(program, false, joints.members());
        let p = &joints.programs;
        Ok(Self {
            follow: kernel(&p.follow)?,
            place: kernel(&p.place)?,
            measure: kernel(&p.measure)?,
            warm_start: kernel(&p.warm_start)?,
            strike: kernel(&p.strike)?,
            push: kernel(&p.push)?,
            relax: kernel(&p.relax)?,
        })
    }
}

impl Kernels {
    pub fn new(gpu: &Gpu, scene: &Scene) -> Result<Self, GpuError> {
        let bindings = bindings(gpu)?;
        let (scanned, sorted) = (layout(gpu, 1, 0), layout(gpu, 2, 1));
        let text = plan::constants(scene.plan.worlds) + &TEXT.concat();
        let scan = include_str!("scan.wgsl");
        let sort = include_str!("sort.wgsl");
        let contact = Members::Seats {
            bodies: row::PREPARED as u32,
            state: ContactTables::new().length as u32,
        };
        let of_contact = |program| gpu.kernel(program, false, contact);
        let joint = |joints| JointKernels::new(gpu, joints);
        let of_run = |program| gpu.kernel(program, true, Members::Runs);
        let p = &scene.programs;
        let groups = scene.groups.iter();
        Ok(Self {
            entries: Entries::new(gpu, &text, &bindings)?,
            bindings,
            scan: gpu.entries(scan, ["groups", "sums", "add"], Some(&scanned))?,
            sort: gpu.entries(sort, ["count", "place"], Some(&sorted))?,
            place: gpu.kernel(&p.place, true, Members::Worlds)?,
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

fn bindings(gpu: &Gpu) -> Result<BindGroupLayout, GpuError> {
    let most = gpu.device().limits().max_storage_buffers_per_shader_stage;
    if most < BINDINGS as u32 {
        return Err(GpuError::Buffers {
            needed: BINDINGS,
            most,
            card: gpu.name().to_owned(),
        });
    }
    Ok(layout(gpu, BINDINGS - READ_ONLY, READ_ONLY))
}

/// Buffers to be written, then others to be read, then a uniform.
fn layout(gpu: &Gpu, written: usize, read: usize) -> BindGroupLayout {
    let storage = |read_only| wgpu::BufferBindingType::Storage { read_only };
    let written = std::iter::repeat_n(storage(false), written);
    let read = std::iter::repeat_n(storage(true), read);
    let uniform = std::iter::once(wgpu::BufferBindingType::Uniform);
    bind_group_layout(gpu.device(), written.chain(read).chain(uniform))
}
