//! Which of the graphics cards of a machine: the same choice for worlds and for images.

#![forbid(unsafe_code)]

use std::str::FromStr;
use wgpu::DeviceType;

/// No card suits a choice.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "no graphics card {wanted}; found: {found}. Install its Vulkan driver, name one of those, or run on the CPU"
)]
pub struct NoCard {
    /// What was asked for.
    pub wanted: String,
    /// What there is.
    pub found: String,
}

/// Which of the graphics cards of this machine.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub enum Choice {
    /// The fastest sort there is: a card of its own before one in the processor. Never a program that stands
    /// in for a card.
    #[default]
    Any,
    /// The first whose name contains this, in capitals or not; a program that stands in for a card, such as
    /// Mesa's llvmpipe, too.
    Named(String),
}

impl FromStr for Choice {
    type Err = std::convert::Infallible;
    /// Nothing for any card, or a part of its name.
    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Ok(match name.trim() {
            "" => Self::Any,
            name => Self::Named(name.to_lowercase()),
        })
    }
}

/// How gladly a card is taken, the least first; not at all unless it is named.
fn rank(kind: DeviceType) -> Option<usize> {
    match kind {
        DeviceType::DiscreteGpu => Some(0),
        DeviceType::IntegratedGpu => Some(1),
        DeviceType::VirtualGpu => Some(2),
        DeviceType::Other => Some(3),
        DeviceType::Cpu => None,
    }
}

impl Choice {
    /// Where the chosen card is in a list of names and kinds.
    fn pick(&self, cards: &[(String, DeviceType)]) -> Option<usize> {
        let all = cards.iter().enumerate();
        match self {
            Self::Any => all
                .filter_map(|(i, card)| Some((rank(card.1)?, i)))
                .min()
                .map(|(_, i)| i),
            Self::Named(name) => {
                let name = name.to_lowercase();
                all.filter(|(_, card)| card.0.to_lowercase().contains(&name))
                    .map(|(i, _)| i)
                    .next()
            }
        }
    }

    /// The card.
    ///
    /// # Errors
    /// There is none that suits, with a list of those that there are.
    pub fn adapter(&self) -> Result<wgpu::Adapter, NoCard> {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
        // Counts of workgroups are written by our own kernels, from numbers that have room: to look at each before it is
        // launched would be a launch more.
        let looks = wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL;
        descriptor.flags.set(looks, cfg!(debug_assertions));
        let instance = wgpu::Instance::new(descriptor);
        let every = instance.enumerate_adapters(wgpu::Backends::PRIMARY);
        let mut adapters = pollster::block_on(every);
        let told = adapters.iter().map(|adapter| {
            let info = adapter.get_info();
            (info.name, info.device_type)
        });
        let cards: Vec<_> = told.collect();
        let Some(i) = self.pick(&cards) else {
            return Err(self.missing(&cards));
        };
        Ok(adapters.swap_remove(i))
    }

    fn missing(&self, cards: &[(String, DeviceType)]) -> NoCard {
        let names = cards.iter().map(|(name, kind)| match kind {
            DeviceType::Cpu => format!("`{name}` (a program, taken where it is named)"),
            _ => format!("`{name}`"),
        });
        let found = match cards {
            [] => "none".into(),
            _ => names.collect::<Vec<_>>().join(", "),
        };
        let wanted = match self {
            Self::Any => "was found".into(),
            Self::Named(name) => format!("has `{name}` in its name"),
        };
        NoCard { wanted, found }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cards() -> Vec<(String, DeviceType)> {
        vec![
            ("llvmpipe (LLVM 15)".into(), DeviceType::Cpu),
            ("Iris Xe".into(), DeviceType::IntegratedGpu),
            ("Radeon Pro".into(), DeviceType::DiscreteGpu),
        ]
    }

    #[test]
    fn the_fastest_sort_is_taken_and_no_program() {
        assert_eq!(Choice::Any.pick(&cards()), Some(2));
        assert_eq!(Choice::Any.pick(&cards()[..2]), Some(1));
        assert_eq!(Choice::Any.pick(&cards()[..1]), None);
    }

    #[test]
    fn a_name_finds_a_program_too() {
        let named = |name: &str| name.parse::<Choice>().unwrap().pick(&cards());
        assert_eq!(named("LLVMpipe"), Some(0));
        assert_eq!(named("iris"), Some(1));
        assert_eq!(named("geforce"), None);
        assert_eq!(named(" "), Choice::Any.pick(&cards()));
    }

    #[test]
    fn what_is_missing_is_told_with_what_there_is() {
        let told = Choice::Any.missing(&cards()[..1]).to_string();
        assert!(told.contains("`llvmpipe (LLVM 15)` (a program"), "{told}");
        let told = Choice::Named("tesla".into()).missing(&[]).to_string();
        assert!(
            told.contains("`tesla`") && told.contains("found: none"),
            "{told}"
        );
    }
}
