//! The state of all worlds, kept to the bit in memory or in a file.
//!
//! A file holds, little-endian:
//!
//! ```text
//! magic                       8 bytes, "KNTRMSNP"
//! version                     u32
//! bytes per number            u32, 4 or 8
//! fingerprint                 u64, of solver and tables
//! worlds W                    u64
//! numbers per world           u64 state s, u64 controls c
//! diverged worlds D           u64
//! state, controls             W · s, then W · c numbers, world after world
//! time                        W · f64 [s]
//! diverged                    D · (u64 world, f64 time [s])
//! checksum                    u32, CRC-32 of all before
//! ```
//!
//! Worlds lie one after the other, not in blocks: what was taken in lanes of one width goes
//! back into lanes of any other.

use crate::{Diverged, Simulation};
use numbers::{Float, Memory};

const MAGIC: [u8; 8] = *b"KNTRMSNP";
const VERSION: u32 = 1;
const HEADER: usize = 56;
const CHECKSUM: usize = 4;

/// States, controls, times and divergences of all worlds at one time, to the bit.
///
/// What was changed after the simulation was made and is no state (the parameters of
/// [`set_world_model`](Simulation::set_world_model)) is not in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    header: Header,
    /// As in the file, from the end of the header to the checksum.
    body: Vec<u8>,
}

/// Why a snapshot cannot be read, or does not fit a simulation.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SnapshotError {
    /// The bytes end too early.
    #[error(
        "the snapshot is cut off: {found} bytes of {expected}; copy the file again, or take the snapshot anew"
    )]
    Truncated {
        /// Bytes there are.
        found: usize,
        /// Bytes there must be, as far as is known.
        expected: usize,
    },
    /// The bytes are something else.
    #[error(
        "this is no snapshot: it does not start with `KNTRMSNP`; give the bytes of one, as they were written"
    )]
    Magic,
    /// A later release wrote it.
    #[error(
        "the snapshot has format version {found}, but this release reads up to {VERSION}: update Kinetarium, or take the snapshot anew"
    )]
    Version {
        /// Its version.
        found: u32,
    },
    /// The bytes are not as they were written.
    #[error("the snapshot is damaged ({0}): copy the file again, or take the snapshot anew")]
    Damaged(&'static str),
    /// The simulation computes in another precision.
    #[error(
        "the snapshot is of {found} numbers, but the simulation computes in {expected}: make the simulation with that precision"
    )]
    Precision {
        /// Precision of the snapshot.
        found: &'static str,
        /// Precision of the simulation.
        expected: &'static str,
    },
    /// The simulation has another model or solver.
    #[error(
        "the snapshot is of another model or another solver: restore it into a simulation made as the one it was taken from"
    )]
    Model,
    /// The simulation has more or fewer worlds.
    #[error(
        "the snapshot is of {found} worlds, but the simulation has {expected}: make a simulation of {found} worlds"
    )]
    Worlds {
        /// Worlds of the snapshot.
        found: u64,
        /// Worlds of the simulation.
        expected: u64,
    },
}

/// The numbers at the start of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Header {
    precision: u32,
    fingerprint: u64,
    worlds: u64,
    state: u64,
    input: u64,
    diverged: u64,
}

impl Header {
    fn of<T: Float>(simulation: &Simulation<T>) -> Self {
        Self {
            precision: size_of::<T>() as u32,
            fingerprint: simulation.fingerprint(),
            worlds: simulation.worlds() as u64,
            state: simulation.state.length() as u64,
            input: simulation.input.length() as u64,
            diverged: simulation.diverged.len() as u64,
        }
    }
    fn to_bytes(self) -> Vec<u8> {
        let counts = [
            self.fingerprint,
            self.worlds,
            self.state,
            self.input,
            self.diverged,
        ];
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend(self.precision.to_le_bytes());
        bytes.extend(counts.into_iter().flat_map(u64::to_le_bytes));
        bytes
    }
    fn from_bytes(bytes: &[u8; HEADER]) -> Result<Self, SnapshotError> {
        let mut fields = Reader(bytes);
        if fields.take() != MAGIC {
            return Err(SnapshotError::Magic);
        }
        let found = u32::from_le_bytes(fields.take());
        if found > VERSION {
            return Err(SnapshotError::Version { found });
        }
        let precision = u32::from_le_bytes(fields.take());
        let mut count = || u64::from_le_bytes(fields.take());
        let (fingerprint, worlds) = (count(), count());
        let (state, input, diverged) = (count(), count(), count());
        if precision != 4 && precision != 8 || diverged > worlds {
            return Err(SnapshotError::Damaged("impossible header"));
        }
        Ok(Self {
            precision,
            fingerprint,
            worlds,
            state,
            input,
            diverged,
        })
    }
    /// Bytes between header and checksum, if a machine can hold them.
    fn body(&self) -> Option<usize> {
        let numbers = self
            .state
            .checked_add(self.input)?
            .checked_mul(self.precision.into())?;
        let worlds = numbers.checked_add(8)?.checked_mul(self.worlds)?;
        worlds
            .checked_add(self.diverged.checked_mul(16)?)?
            .try_into()
            .ok()
    }
    fn precision_name(&self) -> &'static str {
        if self.precision == 4 { "f32" } else { "f64" }
    }
}

/// Bytes, taken from the front. The caller has checked that there are enough.
struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn slice(&mut self, n: usize) -> &'a [u8] {
        let (taken, rest) = self.0.split_at(n);
        self.0 = rest;
        taken
    }
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let mut taken = [0; N];
        taken.copy_from_slice(self.slice(N));
        taken
    }
}

impl Snapshot {
    pub(crate) fn take<T: Float>(simulation: &Simulation<T>) -> Self {
        let header = Header::of(simulation);
        let mut body = Vec::with_capacity(header.body().unwrap_or(0));
        write_worlds(&simulation.state, &mut body);
        write_worlds(&simulation.input, &mut body);
        body.extend(simulation.time.iter().flat_map(|t| t.to_le_bytes()));
        for d in &simulation.diverged {
            body.extend((d.world as u64).to_le_bytes());
            body.extend(d.time.to_le_bytes());
        }
        Self { header, body }
    }

    pub(crate) fn put_back<T: Float>(
        &self,
        simulation: &mut Simulation<T>,
    ) -> Result<(), SnapshotError> {
        self.fits(&Header::of(simulation))?;
        self.check_states::<T>(simulation.alive())?;
        let mut body = Reader(&self.body);
        read_worlds(&mut simulation.state, &mut body);
        read_worlds(&mut simulation.input, &mut body);
        simulation
            .time
            .fill_with(|| f64::from_le_bytes(body.take()));
        let diverged = |_| Diverged {
            world: u64::from_le_bytes(body.take()) as usize,
            time: f64::from_le_bytes(body.take()),
        };
        simulation.diverged = (0..self.header.diverged).map(diverged).collect();
        Ok(())
    }

    fn fits(&self, simulation: &Header) -> Result<(), SnapshotError> {
        let (own, other) = (&self.header, simulation);
        if own.precision != other.precision {
            let (found, expected) = (own.precision_name(), other.precision_name());
            return Err(SnapshotError::Precision { found, expected });
        }
        if (own.fingerprint, own.state, own.input) != (other.fingerprint, other.state, other.input)
        {
            return Err(SnapshotError::Model);
        }
        if own.worlds != other.worlds {
            return Err(SnapshotError::Worlds {
                found: own.worlds,
                expected: other.worlds,
            });
        }
        Ok(())
    }

    /// The states of worlds that run are finite, which kernels count on. `alive` is where a state tells that.
    fn check_states<T: Float>(&self, alive: usize) -> Result<(), SnapshotError> {
        let mut body = Reader(&self.body);
        let mut state = vec![T::default(); self.header.state as usize];
        for _ in 0..self.header.worlds {
            read_world(&mut state, &mut body);
            if state[alive] != T::zero() && !state.iter().all(|x| x.finite()) {
                return Err(SnapshotError::Damaged("a state that is not finite"));
            }
        }
        Ok(())
    }

    /// The snapshot as the bytes of a file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = self.header.to_bytes();
        bytes.extend(&self.body);
        let checksum = crc32fast::hash(&bytes);
        bytes.extend(checksum.to_le_bytes());
        bytes
    }

    /// A snapshot from what [`to_bytes`](Self::to_bytes) gave.
    ///
    /// # Errors
    /// The bytes are cut off, damaged, of a later version, or no snapshot at all.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, SnapshotError> {
        let truncated = |expected| SnapshotError::Truncated {
            found: bytes.len(),
            expected,
        };
        if !MAGIC.starts_with(&bytes[..bytes.len().min(MAGIC.len())]) {
            return Err(SnapshotError::Magic);
        }
        let head = bytes.first_chunk().ok_or(truncated(HEADER + CHECKSUM))?;
        let header = Header::from_bytes(head)?;
        let body = header.body().and_then(|n| n.checked_add(HEADER + CHECKSUM));
        let expected = body.ok_or(SnapshotError::Damaged("impossible sizes"))?;
        if bytes.len() < expected {
            return Err(truncated(expected));
        }
        if bytes.len() > expected {
            return Err(SnapshotError::Damaged("bytes after its end"));
        }
        let (content, checksum) = bytes.split_at(expected - CHECKSUM);
        if crc32fast::hash(content).to_le_bytes() != checksum {
            return Err(SnapshotError::Damaged("wrong checksum"));
        }
        let snapshot = Self {
            header,
            body: content[HEADER..].to_vec(),
        };
        snapshot.check_diverged()?;
        Ok(snapshot)
    }

    /// Every diverged world exists.
    fn check_diverged(&self) -> Result<(), SnapshotError> {
        let start = self.body.len() - 16 * self.header.diverged as usize;
        let mut rows = Reader(&self.body[start..]);
        for _ in 0..self.header.diverged {
            if u64::from_le_bytes(rows.take()) >= self.header.worlds {
                return Err(SnapshotError::Damaged(
                    "a diverged world that does not exist",
                ));
            }
            rows.slice(8);
        }
        Ok(())
    }
}

// Numbers are copied as they lie in memory.
const _: () = assert!(cfg!(target_endian = "little"));

fn write_worlds<T: Float>(memory: &Memory<T>, bytes: &mut Vec<u8>) {
    let mut numbers = vec![T::default(); memory.length()];
    for world in 0..memory.worlds() {
        memory.copy(world, 0, &mut numbers);
        bytes.extend_from_slice(bytemuck::cast_slice(&numbers));
    }
}

fn read_worlds<T: Float>(memory: &mut Memory<T>, bytes: &mut Reader<'_>) {
    let mut numbers = vec![T::default(); memory.length()];
    for world in 0..memory.worlds() {
        read_world(&mut numbers, bytes);
        for (i, x) in numbers.iter().enumerate() {
            memory.set(world, i, *x);
        }
    }
}

fn read_world<T: Float>(numbers: &mut [T], bytes: &mut Reader<'_>) {
    let numbers = bytemuck::cast_slice_mut(numbers);
    numbers.copy_from_slice(bytes.slice(numbers.len()));
}
