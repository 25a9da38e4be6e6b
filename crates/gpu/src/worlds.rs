//! W worlds of one solver in a card's memory.
//!
//! A binding of a card has a largest size, so that worlds lie in *parts* of equal size, each with buffers of its
//! own; scratch is shared, since the parts are stepped one after the other. In a part, a world's number at
//! `offset` lies at `offset · width + world`: the layout of a [`Memory`] of that width.

use crate::memory::{self, NUMBER, buffer, filled};
use crate::pipeline::{WORKGROUP, pipeline};
use crate::{Gpu, GpuError, Programs};
use numbers::Memory;
use rigid::{Kernels, Lengths};
use std::ops::Range;

/// Substeps of one launch: many, as a launch costs some microseconds, and few enough that a card that also
/// draws a desktop is not taken for hung.
const ROUNDS: usize = 16;

/// How much is reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Report {
    /// Where bodies and joints are, and how they move.
    Motion,
    /// The same, and the contacts of the last step.
    Contacts,
    /// Everything.
    Everything,
}

/// Worlds on a card. Reading waits for what was asked before; nothing else does.
#[derive(Debug)]
pub struct Worlds {
    gpu: Gpu,
    programs: Programs,
    lengths: Lengths,
    worlds: usize,
    width: usize,
    parts: Vec<Part>,
    scratch: wgpu::Buffer,
    links: wgpu::Buffer,
    /// One set for all worlds; each part has its own where worlds differ.
    parameters: wgpu::Buffer,
}

/// Some of the worlds.
#[derive(Debug)]
struct Part {
    state: wgpu::Buffer,
    input: wgpu::Buffer,
    output: wgpu::Buffer,
    /// Where worlds have parameters of their own.
    parameters: Option<wgpu::Buffer>,
}

impl Worlds {
    /// Takes memory for worlds of a solver. What they hold is zero until it is written.
    ///
    /// # Errors
    /// The kernel cannot be recorded; one world is larger than a buffer of the card; its memory is full.
    pub fn new(gpu: &Gpu, kernels: &impl Kernels, worlds: usize) -> Result<Self, GpuError> {
        let programs = Programs::record(kernels)?;
        let lengths = kernels.lengths();
        let width = width(gpu, lengths, worlds)?;
        let of = |numbers: usize| buffer(gpu, numbers as u64 * width as u64);
        let parts = (0..worlds.div_ceil(width)).map(|_| {
            Ok(Part {
                state: of(lengths.state)?,
                input: of(lengths.input)?,
                output: of(lengths.output)?,
                parameters: None,
            })
        });
        let numbers: Vec<_> = kernels.parameters().iter().map(|x| *x as f32).collect();
        Ok(Self {
            parts: parts.collect::<Result<_, GpuError>>()?,
            scratch: of(lengths.scratch)?,
            links: filled(gpu, kernels.links())?,
            parameters: filled(gpu, &numbers)?,
            gpu: gpu.clone(),
            programs,
            lengths,
            worlds,
            width,
        })
    }

    /// Number of worlds.
    pub fn worlds(&self) -> usize {
        self.worlds
    }
    /// Worlds of a part: the width of every [`Memory`] that is written or read.
    pub fn width(&self) -> usize {
        self.width
    }
    /// Bytes taken of the card's memory.
    pub fn bytes(&self) -> u64 {
        let l = self.lengths;
        let each = (l.state + l.input + l.output) * self.parts.len() + l.scratch;
        (each * self.width) as u64 * NUMBER + self.parameters.size() + self.links.size()
    }

    /// Sets the state of all worlds.
    pub fn write_state(&mut self, state: &Memory<f32>) {
        self.write(state, |part| &part.state);
    }
    /// Sets the controls of all worlds.
    pub fn write_input(&mut self, input: &Memory<f32>) {
        self.write(input, |part| &part.input);
    }
    /// Gives each world constants of its own.
    ///
    /// # Errors
    /// The card's memory is full, or one world's constants are larger than a buffer; worlds keep what they had.
    pub fn write_parameters(&mut self, parameters: &Memory<f32>) -> Result<(), GpuError> {
        let numbers = parameters.block_size() as u64;
        let (bytes, most) = (numbers * NUMBER, self.gpu.most_bytes());
        if bytes > most {
            let (card, each) = (self.gpu.name().to_owned(), parameters.length() as u64);
            return Err(GpuError::TooLarge {
                bytes: each * NUMBER,
                most,
                card,
            });
        }
        if self.parts.iter().any(|part| part.parameters.is_none()) {
            let buffers = self.parts.iter().map(|_| buffer(&self.gpu, numbers));
            let buffers: Vec<_> = buffers.collect::<Result<_, _>>()?;
            for (part, buffer) in self.parts.iter_mut().zip(buffers) {
                part.parameters = Some(buffer);
            }
        }
        self.write(parameters, |part| {
            part.parameters.as_ref().unwrap_or(&self.parameters)
        });
        Ok(())
    }
    fn write<'a>(&'a self, memory: &Memory<f32>, buffer: impl Fn(&'a Part) -> &'a wgpu::Buffer) {
        self.same_shape(memory);
        for (i, part) in self.parts.iter().enumerate() {
            let numbers = bytemuck::cast_slice(memory.block(i));
            self.gpu.queue().write_buffer(buffer(part), 0, numbers);
        }
    }

    /// Copies these rows of the state of all worlds; the others of `state` stay.
    ///
    /// # Errors
    /// The card failed.
    pub fn read_state(&self, rows: Range<usize>, state: &mut Memory<f32>) -> Result<(), GpuError> {
        self.read(rows, state, |part| &part.state)
    }
    /// Copies these rows of the output of all worlds; the others of `output` stay.
    ///
    /// # Errors
    /// The card failed.
    pub fn read_output(
        &self,
        rows: Range<usize>,
        output: &mut Memory<f32>,
    ) -> Result<(), GpuError> {
        self.read(rows, output, |part| &part.output)
    }
    fn read(
        &self,
        rows: Range<usize>,
        memory: &mut Memory<f32>,
        buffer: impl Fn(&Part) -> &wgpu::Buffer,
    ) -> Result<(), GpuError> {
        self.same_shape(memory);
        let size = memory.block_size();
        let range = rows.start * self.width..rows.end * self.width;
        assert!(range.end <= size, "rows {rows:?} of {}", memory.length());
        for (i, part) in self.parts.iter().enumerate() {
            let numbers = &mut memory.scalars_mut()[i * size..][range.clone()];
            memory::read(&self.gpu, buffer(part), range.clone(), numbers)?;
        }
        Ok(())
    }

    /// Panics where a memory is laid out otherwise.
    fn same_shape(&self, memory: &Memory<f32>) {
        let (own, other) = ((self.worlds, self.width), (memory.worlds(), memory.width()));
        assert_eq!(own, other, "worlds and width");
    }

    /// Advances all worlds by so many substeps.
    ///
    /// # Errors
    /// The kernel cannot be compiled, the card failed.
    pub fn step(&mut self, substeps: usize) -> Result<(), GpuError> {
        let pipeline = pipeline(&self.gpu, &self.programs.step, self.differ())?;
        let (full, rest) = (substeps / ROUNDS, substeps % ROUNDS);
        self.launch(&pipeline, ROUNDS, full)?;
        self.launch(&pipeline, rest, usize::from(rest > 0))
    }
    /// Fills the output of all worlds from their state.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn report(&mut self, report: Report) -> Result<(), GpuError> {
        let program = match report {
            Report::Motion => &self.programs.motion,
            Report::Contacts => &self.programs.contacts,
            Report::Everything => &self.programs.report,
        };
        let pipeline = pipeline(&self.gpu, program, self.differ())?;
        self.launch(&pipeline, 1, 1)
    }

    /// Whether worlds have constants of their own.
    fn differ(&self) -> bool {
        self.parts.iter().any(|part| part.parameters.is_some())
    }

    /// Runs a kernel on every part, `rounds` times in each of so many launches.
    fn launch(
        &self,
        pipeline: &wgpu::ComputePipeline,
        rounds: usize,
        launches: usize,
    ) -> Result<(), GpuError> {
        if launches == 0 {
            return Ok(());
        }
        let launch = self.uniform([self.width as u32, rounds as u32]);
        let groups = (self.width as u32).div_ceil(WORKGROUP);
        let mut encoder = self
            .gpu
            .device()
            .create_command_encoder(&Default::default());
        for part in &self.parts {
            let bindings = self.bindings(part, &launch);
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &bindings, &[]);
            for _ in 0..launches {
                pass.dispatch_workgroups(groups, 1, 1);
            }
        }
        self.gpu.queue().submit([encoder.finish()]);
        self.gpu.check()
    }

    fn uniform(&self, numbers: [u32; 2]) -> wgpu::Buffer {
        let buffer = self.gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some("launch"),
            size: size_of_val(&numbers) as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let bytes = bytemuck::bytes_of(&numbers);
        self.gpu.queue().write_buffer(&buffer, 0, bytes);
        buffer
    }

    fn bindings(&self, part: &Part, launch: &wgpu::Buffer) -> wgpu::BindGroup {
        let parameters = part.parameters.as_ref().unwrap_or(&self.parameters);
        let buffers = [
            &part.state,
            &part.input,
            &part.output,
            &self.scratch,
            parameters,
            &self.links,
            launch,
        ];
        let numbered = buffers.into_iter().zip(0..);
        let entries: Vec<_> = numbered
            .map(|(buffer, binding)| wgpu::BindGroupEntry {
                binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        self.gpu
            .device()
            .create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout: self.gpu.layout(),
                entries: &entries,
            })
    }
}

/// Worlds of a part: as few parts as buffers, workgroups and 32-bit offsets allow, of equal size.
fn width(gpu: &Gpu, lengths: Lengths, worlds: usize) -> Result<usize, GpuError> {
    let memories = [
        lengths.state,
        lengths.input,
        lengths.output,
        lengths.scratch,
    ];
    let longest = memories.into_iter().max().unwrap_or(0).max(1) as u64;
    let most = gpu.most_bytes();
    let groups = gpu.device().limits().max_compute_workgroups_per_dimension;
    let widest = (most / NUMBER).min(u64::from(u32::MAX)) / longest;
    let widest = widest.min(u64::from(groups) * u64::from(WORKGROUP)) as usize;
    if widest == 0 {
        return Err(GpuError::TooLarge {
            bytes: longest * NUMBER,
            most,
            card: gpu.name().to_owned(),
        });
    }
    Ok(worlds.div_ceil(worlds.div_ceil(widest)))
}
