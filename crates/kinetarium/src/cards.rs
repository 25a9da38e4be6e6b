//! Graphics cards that are open.

use crate::{DeviceChoice, DeviceChoiceError};
use sim::{Device, SolverKind};
use std::collections::HashMap;
use std::process;
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// A card that is open. Simulations on it share what is compiled for it.
pub type Card = Arc<dyn Device<f32>>;

/// The cards that a program has open: who asks for one of them is given the same, so that simulations which know nothing of
/// each other share what is compiled.
///
/// It keeps none open. One that nobody holds any more is opened anew, and so is one that has failed, or that was open when
/// this process was forked. What was compiled goes with the last that holds a card or has worlds on it.
///
/// ```
/// use kinetarium::{Cards, DeviceChoice};
/// use std::sync::Arc;
///
/// let cards = Cards::default();
/// let training = cards.open(&DeviceChoice::Auto)?;
/// let evaluation = cards.open(&DeviceChoice::Auto)?;
/// if let (Some(one), Some(other)) = (&training, &evaluation) {
///     assert!(Arc::ptr_eq(one, other));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct Cards(Mutex<Known>);

/// By the process that opened them, and the choice.
type Known = HashMap<(u32, DeviceChoice), Weak<dyn Device<f32>>>;

impl Cards {
    /// The card, or none where worlds are to run on the processor. Other threads that ask wait until it is open.
    ///
    /// # Errors
    /// A card that is not there, with those that are; a build without cards.
    pub fn open(&self, choice: &DeviceChoice) -> Result<Option<Card>, DeviceChoiceError> {
        match choice {
            DeviceChoice::Processor => Ok(None),
            DeviceChoice::Auto => match if_there(self.open(&DeviceChoice::Cuda(0)))? {
                Some(card) => Ok(Some(card)),
                None => if_there(self.open(&DeviceChoice::Card(String::new()))),
            },
            DeviceChoice::Card(name) => self.shared(choice, || gpu(name)).map(Some),
            DeviceChoice::Cuda(number) => self.shared(choice, || cuda(*number)).map(Some),
        }
    }
    /// The same for the solver that the processor would take and a precision, `double` for f64: `auto` takes the processor
    /// for `impulse`, whose worlds are few as a rule, and where a card does not take the precision.
    ///
    /// # Errors
    /// As [`open`](Self::open); a card that was asked for, and double precision.
    pub fn open_for(
        &self,
        choice: &DeviceChoice,
        solver: SolverKind,
        double: bool,
    ) -> Result<Option<Card>, DeviceChoiceError> {
        if *choice == DeviceChoice::Auto && (double || solver == SolverKind::Impulse) {
            return Ok(None);
        }
        match self.open(choice)? {
            Some(card) if double => Err(DeviceChoiceError::Precision(card.name())),
            other => Ok(other),
        }
    }

    /// A card that is known by this choice and works, or else one that is opened.
    fn shared(
        &self,
        choice: &DeviceChoice,
        open: impl FnOnce() -> Result<Card, DeviceChoiceError>,
    ) -> Result<Card, DeviceChoiceError> {
        let mut cards = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        // What another process has open does not work in one that was forked from it.
        let key = (process::id(), choice.clone());
        let known = cards.get(&key).and_then(Weak::upgrade);
        if let Some(card) = known.filter(|card| !card.has_failed()) {
            return Ok(card);
        }
        let card = open()?;
        cards.insert(key, Arc::downgrade(&card));
        Ok(card)
    }
}

/// None for a card that is not there, or for which this build has no part.
fn if_there(
    opened: Result<Option<Card>, DeviceChoiceError>,
) -> Result<Option<Card>, DeviceChoiceError> {
    match opened {
        Err(DeviceChoiceError::NotBuilt(_)) => Ok(None),
        #[cfg(feature = "gpu")]
        Err(DeviceChoiceError::Gpu(gpu::GpuError::NoCard(_))) => Ok(None),
        #[cfg(feature = "cuda")]
        Err(DeviceChoiceError::Cuda(
            cuda::CudaError::NoDriver
            | cuda::CudaError::NoCompiler
            | cuda::CudaError::NoCard { .. }
            | cuda::CudaError::TooOld { .. },
        )) => Ok(None),
        other => other,
    }
}

#[cfg(feature = "gpu")]
fn gpu(name: &str) -> Result<Card, DeviceChoiceError> {
    let Ok(choice) = name.parse();
    Ok(Arc::new(gpu::Gpu::open(&choice)?))
}

#[cfg(not(feature = "gpu"))]
fn gpu(_: &str) -> Result<Card, DeviceChoiceError> {
    Err(DeviceChoiceError::NotBuilt("gpu"))
}

#[cfg(feature = "cuda")]
fn cuda(number: usize) -> Result<Card, DeviceChoiceError> {
    Ok(Arc::new(cuda::Cuda::open(number)?))
}

#[cfg(not(feature = "cuda"))]
fn cuda(_: usize) -> Result<Card, DeviceChoiceError> {
    Err(DeviceChoiceError::NotBuilt("cuda"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use sim::{DeviceError, DeviceWorlds};
    use std::sync::atomic::{AtomicBool, Ordering};

    /// A card that fails when it is told to.
    #[derive(Default)]
    struct Fragile(AtomicBool);

    impl Device<f32> for Fragile {
        fn name(&self) -> String {
            "fragile".into()
        }
        fn place(
            &self,
            _: rigid::Solver<'_>,
            _: usize,
        ) -> Result<Box<dyn DeviceWorlds<f32>>, DeviceError> {
            Err(DeviceError::new("it takes nothing"))
        }
        fn has_failed(&self) -> bool {
            self.0.load(Ordering::Relaxed)
        }
    }

    #[test]
    fn a_card_is_shared_while_it_is_held_and_works() {
        let cards = Cards::default();
        let open = |fragile: &Arc<Fragile>| {
            let card: Card = fragile.clone();
            cards.shared(&DeviceChoice::Cuda(0), || Ok(card)).unwrap()
        };
        let made = [(); 3].map(|()| Arc::new(Fragile::default()));
        let is =
            |card: &Card, nth: usize| std::ptr::addr_eq(Arc::as_ptr(card), Arc::as_ptr(&made[nth]));
        let first = open(&made[0]);
        let same = open(&made[1]);
        assert!(is(&first, 0) && is(&same, 0));
        made[0].0.store(true, Ordering::Relaxed);
        let other = open(&made[1]);
        assert!(is(&other, 1) && is(&open(&made[2]), 1));
    }

    #[test]
    fn a_card_that_nobody_holds_goes() {
        let cards = Cards::default();
        let choice = DeviceChoice::Cuda(0);
        let open = || {
            cards
                .shared(&choice, || Ok(Arc::new(Fragile::default())))
                .unwrap()
        };
        let held = Arc::downgrade(&open());
        assert!(held.upgrade().is_none());
        assert_eq!(open().name(), "fragile");
    }

    #[test]
    fn a_choice_that_cannot_be_met_is_told_each_time() {
        let cards = Cards::default();
        let choice = "gpu:no such card".parse().unwrap();
        for _ in 0..2 {
            assert!(cards.open(&choice).is_err());
        }
    }

    #[cfg(feature = "gpu")]
    #[test]
    #[ignore = "needs a graphics card or Mesa's llvmpipe"]
    fn simulations_that_name_the_same_card_are_on_one() {
        let name = std::env::var("KINETARIUM_GPU").unwrap_or_default();
        let (cards, choice) = (Cards::default(), DeviceChoice::Card(name));
        let make = |worlds| {
            let card = cards.open(&choice).unwrap().unwrap();
            let settings = sim::SimulationSettings::new(worlds, 0.002);
            let model = model::examples::n_pendula(3).unwrap();
            let mut simulation = sim::Simulation::on(&*card, model, settings).unwrap();
            simulation.try_step(1).unwrap();
            card
        };
        let (training, evaluation) = (make(64), make(3));
        assert!(Arc::ptr_eq(&training, &evaluation));
    }
}
