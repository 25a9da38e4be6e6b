//! Numbers of all worlds where a device has them, for other libraries of this process.

use crate::device::{Address, Remote};
use crate::{Control, Quantity, Simulation, SimulationError};
use numbers::Float;

/// Numbers (`f32`) in the memory of a device: `[world][row][number]`, as far apart as `strides` tells, in numbers.
///
/// The memory lasts as long as the simulation. What is asked of the device later, by this library or by another on the
/// device's default stream, is done after what was asked before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DeviceArray {
    /// Where the first number lies.
    pub address: Address,
    /// Worlds, rows, numbers of a row.
    pub shape: [usize; 3],
    /// From one to the next of each.
    pub strides: [usize; 3],
}

impl<T: Float> Simulation<T> {
    /// Where a quantity of the present state lies on the device, to be read. Nothing is copied to the host. It holds
    /// until the worlds are stepped or set, or another quantity is asked for; then ask again.
    ///
    /// # Errors
    /// Worlds are not on a device that shares its memory, as CUDA's do, but for `impulse`; the quantity is worked out on
    /// the host (those of contacts, and [`CenterOfMass`](Quantity::CenterOfMass) and the spatial ones); the device fails.
    pub fn quantity_on_device(
        &mut self,
        quantity: Quantity,
    ) -> Result<DeviceArray, SimulationError> {
        let rows = quantity.rows(&self.output_tables, self.model());
        let rows = rows.ok_or_else(|| SimulationError::NotShared {
            what: format!("{quantity:?}"),
            remedy: "it is worked out on the host: read it",
        })?;
        self.report(quantity.needs())?;
        let remote = self.remote.as_ref();
        let address = remote.map_or(Ok(None), Remote::output_address)?;
        self.shared_array(address, rows)
    }

    /// Where a control lies on the device, to be read and written: what stands there when worlds are stepped acts, and
    /// is not checked. What the host sets of the same control is written over it, in all worlds, before the next step;
    /// resets change the worlds that are reset.
    ///
    /// # Errors
    /// Worlds are not on a device that shares its memory, as CUDA's do, but for `impulse`; the device fails.
    pub fn control_on_device(&mut self, control: Control) -> Result<DeviceArray, SimulationError> {
        let range = self.controls().range(control);
        self.tell()?;
        let remote = self.remote.as_mut();
        let address = remote.map_or(Ok(None), |remote| remote.share_input(range.clone()))?;
        self.shared_array(address, (range, 1, 1))
    }

    /// Rows that begin in a range, so far apart, of so many numbers each.
    fn shared_array(
        &self,
        memory: Option<Address>,
        (range, stride, width): (std::ops::Range<usize>, usize, usize),
    ) -> Result<DeviceArray, SimulationError> {
        let memory = memory.ok_or_else(|| SimulationError::NotShared {
            what: format!("the memory of {}", self.device().unwrap_or("the processor")),
            remedy: "run on the device cuda, by featherstone or xpbd, or read and write arrays on the host",
        })?;
        let worlds = self.worlds();
        let first = (range.start * worlds * size_of::<f32>()) as u64;
        Ok(DeviceArray {
            address: Address {
                at: memory.at + first,
                ..memory
            },
            shape: [worlds, range.len().div_ceil(stride), width],
            strides: [1, stride * worlds, worlds],
        })
    }
}
