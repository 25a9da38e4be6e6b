//! Time on a card, by its own clock.

use crate::memory::Staging;
use crate::{Gpu, GpuError};
use sim::Stage;
use std::iter::once;

/// Marks in a set: the most that it can have.
const MARKS: usize = wgpu::QUERY_SET_MAX_QUERIES as usize;
/// Bytes of a mark.
const MARK: u64 = wgpu::QUERY_SIZE as u64;

/// What stages of passes take.
#[derive(Debug)]
pub struct Clock {
    device: wgpu::Device,
    /// As many as the marks have filled until they were read.
    sets: Vec<wgpu::QuerySet>,
    staging: Staging,
    /// Which stage ends with each mark that is not yet read, none with the first of a pass; and how many launches it had.
    marks: Vec<(Option<&'static str>, u64)>,
    /// Launches since the last one.
    launches: u64,
    /// What stages have taken so far, in the order in which they were first seen.
    times: Vec<Stage>,
}

impl Clock {
    /// What a card needs for one.
    pub const FEATURES: wgpu::Features =
        wgpu::Features::TIMESTAMP_QUERY.union(wgpu::Features::TIMESTAMP_QUERY_INSIDE_PASSES);

    /// Of a card that has one.
    pub fn new(gpu: &Gpu) -> Option<Self> {
        let device = gpu.device();
        device.features().contains(Self::FEATURES).then(|| Self {
            device: device.clone(),
            sets: Vec::new(),
            staging: Staging::default(),
            marks: Vec::new(),
            launches: 0,
            times: Vec::new(),
        })
    }

    /// What stages have taken.
    pub fn times(self) -> Vec<Stage> {
        self.times
    }

    /// A kernel is launched.
    pub fn launches(&mut self) {
        self.launches += 1;
    }
    /// What was launched in a pass since the mark before belongs to a stage; to none what was before the pass.
    pub fn mark(&mut self, pass: &mut wgpu::ComputePass<'_>, stage: Option<&'static str>) {
        let (set, index) = (self.marks.len() / MARKS, self.marks.len() % MARKS);
        if set == self.sets.len() {
            let set = wgpu::QuerySetDescriptor {
                label: None,
                ty: wgpu::QueryType::Timestamp,
                count: MARKS as u32,
            };
            self.sets.push(self.device.create_query_set(&set));
        }
        pass.write_timestamp(&self.sets[set], index as u32);
        self.marks.push((stage, std::mem::take(&mut self.launches)));
    }

    /// Reads the marks of what is submitted.
    pub fn read(&mut self, gpu: &Gpu) -> Result<(), GpuError> {
        let marks = std::mem::take(&mut self.marks);
        if marks.is_empty() {
            return Ok(());
        }
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let resolved = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: marks.len() as u64 * MARK,
            usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        for (nth, (set, marks)) in self.sets.iter().zip(marks.chunks(MARKS)).enumerate() {
            let at = (nth * MARKS) as u64 * MARK;
            encoder.resolve_query_set(set, 0..marks.len() as u32, &resolved, at);
        }
        let period = f64::from(gpu.queue().get_timestamp_period()) * 1e-9;
        let times = &mut self.times;
        let numbers = once(0..2 * marks.len());
        let staging = &mut self.staging;
        staging.fetch(gpu, encoder, &resolved, numbers, |read| {
            let ticks: Vec<u64> = bytemuck::pod_collect_to_vec(read);
            for (mark, ticks) in marks.iter().skip(1).zip(ticks.windows(2)) {
                let ((Some(name), launches), [from, to]) = (*mark, ticks) else {
                    continue;
                };
                let seconds = to.saturating_sub(*from) as f64 * period;
                let stage = Stage {
                    name,
                    seconds,
                    launches,
                };
                stage.add_to(times);
            }
        })
    }
}
