//! What a step of a pile consists of, compiled.

use super::plan;
use super::scene::Scene;
use crate::pipeline::WORKGROUP;
use crate::{Gpu, GpuError};
use numbers::trace::{Members, PrintOptions, Program};
use rigid::impulse::row;
use wgpu::{BindGroupLayout, ComputePipeline};

/// What lies between the kernels. One text, since all see the same buffers.
const TEXT: [&str; 6] = [
    include_str!("bindings.wgsl"),
    include_str!("bodies.wgsl"),
    include_str!("broad_phase.wgsl"),
    include_str!("narrow_phase.wgsl"),
    include_str!("colours.wgsl"),
    include_str!("contacts.wgsl"),
];

/// Storage buffers that it binds, the last two to be read only; and the plan.
pub(super) const BINDINGS: usize = 16;
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
                Ok(Self {
                    $($name: gpu.entry(text, stringify!($name), Some(bindings))?,)+
                })
            }
        }
    };
}

entries! {
    clear, load_bodies, load_shapes,
    surround, count_buckets, fill_buckets, count_pairs, list_pairs, plan_groups,
    seat_pairs, part_pairs, find_touching, make_contacts,
    join, paint, settle, plan_colours, seat_contacts, find_pressing,
    find_blows, read_contacts, check_bodies, check_shapes,
    store_bodies, store_contacts, end,
}

/// All of it.
#[derive(Debug)]
pub(super) struct Kernels {
    pub bindings: BindGroupLayout,
    /// Words and a uniform; words, status and a uniform.
    pub scanned: BindGroupLayout,
    pub sorted: BindGroupLayout,
    pub entries: Entries,
    pub scan: [ComputePipeline; 3],
    pub sort: [ComputePipeline; 2],
    pub place: ComputePipeline,
    pub begin: ComputePipeline,
    pub advance: ComputePipeline,
    pub advance_again: ComputePipeline,
    pub drift: ComputePipeline,
    pub finish: ComputePipeline,
    pub prepare: ComputePipeline,
    pub foresee: ComputePipeline,
    pub warm_start: ComputePipeline,
    pub push: ComputePipeline,
    pub relax: ComputePipeline,
    /// Of each group of pairs: which are apart, and where they touch.
    pub apart: Vec<Option<ComputePipeline>>,
    pub groups: Vec<ComputePipeline>,
}

impl Kernels {
    pub fn new(gpu: &Gpu, scene: &Scene) -> Result<Self, GpuError> {
        let bindings = bindings(gpu)?;
        let (scanned, sorted) = (layout(gpu, 1, 0), layout(gpu, 2, 0));
        let text = plan::constants() + &TEXT.concat();
        let scan = include_str!("scan.wgsl");
        let sort = include_str!("sort.wgsl");
        let (body, pair) = (Members::Runs, Members::Runs);
        let contact = Members::Seats(row::PREPARED as u32);
        let kernel = |program: &Program, members, own_parameters| {
            let text = program.to_wgsl(&PrintOptions {
                workgroup_size: WORKGROUP,
                parameters_per_world: own_parameters,
                members,
            })?;
            gpu.pipeline(&text, Some(gpu.layout()))
        };
        let p = &scene.programs;
        let groups = scene.groups.iter();
        Ok(Self {
            entries: Entries::new(gpu, &text, &bindings)?,
            bindings,
            scan: [
                gpu.entry(scan, "groups", Some(&scanned))?,
                gpu.entry(scan, "sums", Some(&scanned))?,
                gpu.entry(scan, "add", Some(&scanned))?,
            ],
            sort: [
                gpu.entry(sort, "count", Some(&sorted))?,
                gpu.entry(sort, "place", Some(&sorted))?,
            ],
            place: kernel(&p.place, Members::Worlds, true)?,
            begin: kernel(&p.begin, body, true)?,
            advance: kernel(&p.advance, body, true)?,
            advance_again: kernel(&p.advance_again, body, true)?,
            drift: kernel(&p.drift, body, true)?,
            finish: kernel(&p.finish, body, true)?,
            prepare: kernel(&p.prepare, contact, false)?,
            foresee: kernel(&p.foresee, contact, false)?,
            warm_start: kernel(&p.warm_start, contact, false)?,
            push: kernel(&p.push, contact, false)?,
            relax: kernel(&p.relax, contact, false)?,
            apart: groups
                .clone()
                .map(|group| {
                    group
                        .apart
                        .as_ref()
                        .map(|p| kernel(p, pair, true))
                        .transpose()
                })
                .collect::<Result<_, _>>()?,
            groups: groups
                .map(|group| kernel(&group.program, pair, true))
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
    let kind = |i: usize| {
        if i == written + read {
            wgpu::BufferBindingType::Uniform
        } else {
            let read_only = i >= written;
            wgpu::BufferBindingType::Storage { read_only }
        }
    };
    let entry = |i: usize| wgpu::BindGroupLayoutEntry {
        binding: i as u32,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty: kind(i),
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    };
    let entries = Vec::from_iter((0..=written + read).map(entry));
    let descriptor = wgpu::BindGroupLayoutDescriptor {
        label: None,
        entries: &entries,
    };
    gpu.device().create_bind_group_layout(&descriptor)
}
