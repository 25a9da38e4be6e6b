//! A world's trajectory is the same bits whatever stands beside it, and wherever it runs.

mod scene;

use kinetarium_sim::{Simulation, SimulationSettings};
use model::Model;
use numbers::Float;
use numbers::dispatch::Isa;
use scene::{BOTH, METHODS, Method, chain, hash, hashes, mixed, scatter, scattered};

/// More than a register has lanes, and not a multiple of them.
const FEW: usize = 17;
const MANY: usize = 4096;
const STEPS: usize = 30;

/// Hashes of worlds with these seeds, after some steps.
fn run<T: Float>(
    model: &Model,
    settings: SimulationSettings,
    seed: impl Fn(usize) -> usize,
) -> Vec<u64> {
    let mut simulation = scattered::<T>(model, settings, seed);
    simulation.step(STEPS);
    assert!(
        simulation.diverged().is_empty(),
        "{:?}",
        simulation.diverged()
    );
    hashes(&mut simulation)
}

fn fused() -> Vec<Isa> {
    Isa::available()
        .into_iter()
        .filter(|isa| isa.fused())
        .collect()
}

fn portable() -> Isa {
    "portable".parse().expect("it is on every machine")
}

/// The same bits in lanes and scalars of these instruction sets, with 1 and 2 threads, in another
/// lane, and alone.
fn few_worlds_agree<T: Float>(model: &Model, method: Method, isas: &[Isa]) {
    let with = |isa| SimulationSettings {
        isa: Some(isa),
        ..method.settings(FEW)
    };
    let Some(&first) = isas.first() else { return };
    let expected = run::<T>(model, with(first), |w| w);
    for &isa in isas {
        for (threads, scalar) in [(1, false), (2, false), (1, true), (2, true)] {
            let settings = SimulationSettings {
                threads,
                scalar,
                ..with(isa)
            };
            assert_eq!(run::<T>(model, settings, |w| w), expected, "{settings:?}");
        }
        let mut moved = run::<T>(model, with(isa), |w| (w + 5) % FEW);
        moved.rotate_right(5);
        assert_eq!(moved, expected, "{isa}: in another lane");
        let alone = SimulationSettings {
            worlds: 1,
            ..with(isa)
        };
        for seed in [0, 7, 16] {
            assert_eq!(
                run::<T>(model, alone, |_| seed),
                [expected[seed]],
                "{isa}: alone"
            );
        }
    }
}

fn all_methods_agree<T: Float>(model: &Model) {
    for method in METHODS {
        few_worlds_agree::<T>(model, method, &fused());
    }
}

#[test]
fn a_mixed_tree_moves_alike_everywhere_in_single_precision() {
    all_methods_agree::<f32>(&mixed());
}

#[test]
fn a_mixed_tree_moves_alike_everywhere_in_double_precision() {
    all_methods_agree::<f64>(&mixed());
}

#[test]
fn a_chain_moves_alike_everywhere() {
    all_methods_agree::<f32>(&chain());
    all_methods_agree::<f64>(&chain());
}

/// Without fused multiply-add the bits are others, but again the same in all worlds.
#[test]
fn portable_agrees_with_itself() {
    for method in BOTH {
        few_worlds_agree::<f32>(&mixed(), method, &[portable()]);
        few_worlds_agree::<f64>(&mixed(), method, &[portable()]);
    }
}

/// Thousands of worlds, the other way round: each in another lane of another block.
fn many_worlds_agree<T: Float>(model: &Model, method: Method) {
    let with = |isa, threads, worlds| {
        let isa = Some(isa);
        SimulationSettings {
            isa,
            threads,
            ..method.settings(worlds)
        }
    };
    let Some(&first) = fused().first() else {
        return;
    };
    let few = run::<T>(model, with(first, 1, FEW), |w| w);
    let many = run::<T>(model, with(first, 1, MANY), |w| w);
    assert_eq!(many[..FEW], few, "{method:?}");
    for isa in fused() {
        let mut turned = run::<T>(model, with(isa, 2, MANY), |w| MANY - 1 - w);
        turned.reverse();
        assert!(turned == many, "{method:?}, {isa}, 2 threads");
    }
    let alone = run::<T>(model, with(first, 1, 1), |_| MANY - 1);
    assert_eq!(alone, many[MANY - 1..], "{method:?}");
}

#[test]
fn thousands_of_worlds_move_as_few_do() {
    for method in METHODS {
        many_worlds_agree::<f32>(&mixed(), method);
        many_worlds_agree::<f64>(&mixed(), method);
    }
    for method in BOTH {
        many_worlds_agree::<f32>(&chain(), method);
    }
}

/// The same bits from a simulation that is led otherwise as from one that steps at once.
fn led_otherwise(lead: impl Fn(&mut Simulation<f32>)) {
    for method in METHODS {
        let expected = run::<f32>(&mixed(), method.settings(FEW), |w| w);
        let mut simulation = scattered::<f32>(&mixed(), method.settings(FEW), |w| w);
        lead(&mut simulation);
        assert_eq!(hashes(&mut simulation), expected, "{method:?}");
    }
}

#[test]
fn many_calls_of_step_are_one() {
    led_otherwise(|simulation| {
        for _ in 0..STEPS {
            simulation.step(1);
        }
    });
}

#[test]
fn reporting_changes_nothing() {
    led_otherwise(|simulation| {
        simulation.outputs();
        for _ in 0..STEPS {
            simulation.step(1);
            simulation.outputs();
        }
    });
}

#[test]
fn a_restored_snapshot_goes_on_alike() {
    led_otherwise(|simulation| {
        simulation.step(10);
        let snapshot = simulation.snapshot();
        simulation.step(17);
        simulation.reset_all();
        simulation.restore(&snapshot).unwrap();
        simulation.step(STEPS - 10);
    });
}

#[test]
fn a_reset_world_starts_again_and_disturbs_no_other() {
    for method in BOTH {
        let expected = run::<f32>(&mixed(), method.settings(FEW), |w| w);
        let mut simulation = scattered::<f32>(&mixed(), method.settings(FEW), |w| w);
        simulation.step(STEPS);
        simulation.reset(&[5]).unwrap();
        let mut fresh = Simulation::<f32>::new(mixed(), method.settings(FEW)).unwrap();
        assert_eq!(hash(&mut simulation, 5), hash(&mut fresh, 0));
        assert_eq!((simulation.time(5), simulation.time(6)), (0.0, 0.06));

        scatter(&mut simulation, 5, 5);
        simulation.step(STEPS);
        assert_eq!(hash(&mut simulation, 5), expected[5], "{method:?}");
        let mut undisturbed = scattered::<f32>(&mixed(), method.settings(FEW), |w| w);
        undisturbed.step(2 * STEPS);
        for world in (0..FEW).filter(|&w| w != 5) {
            assert_eq!(
                hash(&mut simulation, world),
                hash(&mut undisturbed, world),
                "{method:?}"
            );
        }
    }
}

/// One hash of a few worlds for each precision, f32 and f64.
fn golden(model: &Model, method: Method) -> [u64; 2] {
    let all = |hashes: Vec<u64>| {
        hashes
            .into_iter()
            .fold(0, |sum: u64, h| sum.rotate_left(5) ^ h)
    };
    let settings = SimulationSettings {
        isa: Some(Isa::detect()),
        ..method.settings(3)
    };
    [
        all(run::<f32>(model, settings, |w| w)),
        all(run::<f64>(model, settings, |w| w)),
    ]
}

/// A change of any bit is noticed here. Where it was meant, replace the numbers by those that
/// the failure shows, and say in the changelog that trajectories have changed.
///
/// The numbers hold where multiply-add is fused and the mathematical library, which places the
/// initial states, is glibc's: on x86-64 Linux with AVX2.
#[test]
#[cfg(all(target_arch = "x86_64", target_os = "linux", target_env = "gnu"))]
fn trajectories_have_the_recorded_bits() {
    if fused().is_empty() {
        return;
    }
    let found = [mixed(), chain()].map(|model| METHODS.map(|method| golden(&model, method)));
    assert_eq!(found, GOLDEN, "found:\n{found:#018x?}");
}

/// For the mixed tree and the chain: of each method, f32 and f64.
#[cfg(all(target_arch = "x86_64", target_os = "linux", target_env = "gnu"))]
const GOLDEN: [[[u64; 2]; 5]; 2] = [
    [
        [0x5814_1e86_6f41_ba01, 0x1105_8fb8_b955_ae3a],
        [0xdd9a_3747_e426_84c8, 0x1f28_6594_369b_6c13],
        [0x9a63_b62c_f9cf_25f2, 0x6dbc_662d_8e81_6f3a],
        [0xb54e_5c6f_5669_e69e, 0x4d4d_5b51_d89a_31d8],
        [0xa2b0_50c9_fc02_9b8e, 0xa403_e87d_9d9b_8716],
    ],
    [
        [0x2fad_95f0_fe37_2710, 0x291a_017c_874e_e466],
        [0x5c32_5a71_7834_c9ef, 0x1201_b862_bf70_1d7f],
        [0x9ce8_44dd_4d87_c92a, 0x91e2_52ec_9f3e_73c0],
        [0x0866_97fd_0996_eaba, 0xf82a_ffc5_4b68_14e4],
        [0x0c8c_075e_ae4f_b4ad, 0x71a0_59d3_9a34_38e8],
    ],
];
