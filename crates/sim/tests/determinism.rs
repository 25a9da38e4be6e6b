//! A world's trajectory is the same bits whatever stands beside it, and wherever it runs.

mod scene;

use kinetarium_sim::{Simulation, SimulationSettings, SolverKind};
use model::Model;
use numbers::Float;
use numbers::dispatch::Isa;
use scene::{BOTH, METHODS, Method, TOUCHING, chain, hash, hashes, mixed, scatter, scattered};

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

fn few_worlds_agree<T: Float>(model: &Model, method: Method, isas: &[Isa]) {
    few_agree(method, isas, |settings, seed| {
        run::<T>(model, settings, seed)
    });
}

/// The same bits in lanes and scalars of these instruction sets, with 1 and 2 threads, in another
/// lane, and alone; `run` gives the hashes of worlds with these seeds.
fn few_agree(
    method: Method,
    isas: &[Isa],
    run: impl Fn(SimulationSettings, &dyn Fn(usize) -> usize) -> Vec<u64>,
) {
    let with = |isa| SimulationSettings {
        isa: Some(isa),
        ..method.settings(FEW)
    };
    let Some(&first) = isas.first() else { return };
    let expected = run(with(first), &|w| w);
    for &isa in isas {
        for (threads, scalar) in [(1, false), (2, false), (1, true), (2, true)] {
            let settings = SimulationSettings {
                threads,
                scalar,
                ..with(isa)
            };
            assert_eq!(run(settings, &|w| w), expected, "{settings:?}");
        }
        let mut moved = run(with(isa), &|w| (w + 5) % FEW);
        moved.rotate_right(5);
        assert_eq!(moved, expected, "{isa}: in another lane");
        let alone = SimulationSettings {
            worlds: 1,
            ..with(isa)
        };
        for seed in [0, 7, 16] {
            assert_eq!(run(alone, &|_| seed), [expected[seed]], "{isa}: alone");
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

/// Contacts are settled lane by lane: what one still has to settle must not move its neighbours.
#[test]
fn a_heap_moves_alike_everywhere() {
    for method in TOUCHING {
        few_worlds_agree::<f32>(&method.heap(), method, &fused());
        few_worlds_agree::<f64>(&method.heap(), method, &fused());
    }
}

/// What floats freely starts lower along an axis [m].
fn lowered(model: Model, axis: usize, by: f64) -> Model {
    let mut parts = model.into_parts();
    let free = |joint: &&mut model::Joint| joint.kind == model::JointKind::Free;
    for joint in parts.joints.iter_mut().filter(free) {
        joint.initial[axis] -= by;
    }
    Model::new(parts).unwrap()
}

/// A person of 21 motors, lying a little above the ground, arms and legs at their sides.
fn humanoid() -> Model {
    let (name, text) = (
        "humanoid.xml",
        include_str!("../../session/models/humanoid.xml"),
    );
    let files = formats::InMemory::new([(name, text)]);
    let options = formats::Options::default();
    let model = formats::parse(text, name, &files, &options).unwrap().model;
    let mut parts = lowered(model, 2, 1.12).into_parts();
    parts.joints[0].initial[3..].copy_from_slice(&[0.0, 0.6, 0.0, 0.8]);
    Model::new(parts).unwrap()
}

/// Rounds of [`struggle`], and the steps of each.
const ROUNDS: usize = 40;
const HOLD: usize = 10;

/// Worlds of robots, which lie in other poses; with other random controls in each round.
struct Struggle<'a, T: Float> {
    simulation: Simulation<T>,
    seed: &'a dyn Fn(usize) -> usize,
}

impl<'a, T: Float> Struggle<'a, T> {
    fn new(model: &Model, settings: SimulationSettings, seed: &'a dyn Fn(usize) -> usize) -> Self {
        Self {
            simulation: scattered(model, settings, seed),
            seed,
        }
    }
    fn go(&mut self, rounds: std::ops::Range<usize>) {
        let actuators = self.simulation.model().actuators.len();
        for round in rounds {
            for world in 0..self.simulation.worlds() {
                let seed = (self.seed)(world) * ROUNDS + round;
                let mut random = fastrand::Rng::with_seed(seed as u64);
                let control: Vec<_> = (0..actuators).map(|_| 2.0 * random.f64() - 1.0).collect();
                let mut controls = self.simulation.controls();
                controls.set_control(world, &control).unwrap();
            }
            let lost = self.simulation.step(HOLD);
            assert!(lost.is_empty(), "{lost:?}");
        }
    }
    /// In how many worlds the robot presses on the ground, and in how many on itself or another.
    fn pressing(&mut self) -> [usize; 2] {
        let model = self.simulation.model().clone();
        let worlds = 0..self.simulation.worlds();
        let outputs = self.simulation.outputs();
        [false, true].map(|itself| {
            let moves = |shape: model::ShapeId| model.shapes[shape.0].body.is_some();
            let presses = |world: &usize| {
                outputs.contacts(*world).any(|c| {
                    c.force != glam::DVec3::ZERO && c.shapes.into_iter().all(moves) == itself
                })
            };
            worlds.clone().filter(presses).count()
        })
    }
}

/// Hashes of worlds of robots that struggle on the ground, most of which press on it half way; from a snapshot taken
/// there they go on alike.
fn struggle<T: Float>(
    model: &Model,
    settings: SimulationSettings,
    seed: &dyn Fn(usize) -> usize,
) -> Vec<u64> {
    let mut run = Struggle::<T>::new(model, settings, seed);
    run.go(0..ROUNDS / 2);
    let [ground, itself] = run.pressing();
    // Somebody may just be tossing about.
    let all = settings.worlds;
    assert!(
        all == 1 || 3 * ground >= 2 * all,
        "{ground} of {settings:?}"
    );
    assert!(all < FEW || itself > 0, "of {settings:?}");
    let snapshot = run.simulation.snapshot();
    run.go(ROUNDS / 2..ROUNDS);
    let first = hashes(&mut run.simulation);
    run.simulation.restore(&snapshot).unwrap();
    run.go(ROUNDS / 2..ROUNDS);
    assert_eq!(hashes(&mut run.simulation), first, "from a snapshot");
    first
}

fn robots_agree<T: Float>(model: &Model, method: Method, isas: &[Isa]) {
    few_agree(method, isas, |settings, seed| {
        struggle::<T>(model, settings, seed)
    });
}

/// On the ground, with contacts with itself, and motors under random controls.
#[test]
fn a_humanoid_struggles_alike_everywhere() {
    for method in [Method::Touching, Method::TouchingXpbd] {
        robots_agree::<f32>(&humanoid(), method, &fused());
        robots_agree::<f64>(&humanoid(), method, &fused());
        robots_agree::<f32>(&humanoid(), method, &[portable()]);
    }
}

/// In 256 worlds as in 17, the other way round and shared by threads.
#[test]
fn humanoids_struggle_alike_among_hundreds() {
    const WORLDS: usize = 256;
    for method in [Method::Touching, Method::TouchingXpbd] {
        let model = humanoid();
        let few = struggle::<f32>(&model, method.settings(FEW), &|w| w);
        let settings = SimulationSettings {
            threads: 2,
            ..method.settings(WORLDS)
        };
        let mut many = struggle::<f32>(&model, settings, &|w| WORLDS - 1 - w);
        many.reverse();
        assert_eq!(many[..FEW], few, "{method:?}");
    }
}

/// Limp people, in as many worlds as you like.
#[test]
fn people_fall_alike_in_many_worlds() {
    let people = model::examples::ragdolls(2).unwrap();
    let people = lowered(people, 1, 0.8);
    robots_agree::<f32>(&people, Method::Impulse, &fused());
    let first = fused().first().copied();
    robots_agree::<f64>(&people, Method::Impulse, first.as_slice());
}

/// A wall of boxes that leans and falls, so large that threads share it, and then a snapshot of it.
fn a_wall_falls<T: Float>(isa: Isa, threads: usize, scalar: bool) -> [u64; 2] {
    falls::<T>(&model::examples::pyramid(16).unwrap(), isa, threads, scalar)
}

/// A world of `impulse` that is pushed at many bodies and falls, and then a snapshot of it.
fn falls<T: Float>(model: &Model, isa: Isa, threads: usize, scalar: bool) -> [u64; 2] {
    let settings = SimulationSettings {
        isa: Some(isa),
        threads,
        scalar,
        ..Method::Impulse.settings(1)
    };
    let mut simulation = Simulation::<T>::new(model.clone(), settings).unwrap();
    let position = simulation.outputs().joint_position(0);
    let mut velocity = vec![0.0; simulation.model().degrees_of_freedom()];
    for body in velocity.chunks_exact_mut(6).step_by(7) {
        (body[0], body[2], body[4]) = (1.0, 0.5, 2.0);
    }
    simulation.set_joint_state(0, &position, &velocity).unwrap();
    simulation.step(30);
    let snapshot = simulation.snapshot();
    simulation.step(30);
    let first = hash(&mut simulation, 0);
    simulation.restore(&snapshot).unwrap();
    simulation.step(30);
    [first, hash(&mut simulation, 0)]
}

/// A heap of people, with joints of three axes and of one, stops, and contacts.
#[test]
fn people_fall_alike_everywhere() {
    let people = model::examples::ragdolls(12).unwrap();
    let Some(&first) = fused().first() else {
        return;
    };
    let expected = falls::<f32>(&people, first, 1, false);
    assert_eq!(expected[0], expected[1], "from a snapshot");
    for isa in fused() {
        for (threads, scalar) in [(2, false), (3, false), (1, true), (2, true)] {
            let found = falls::<f32>(&people, isa, threads, scalar);
            assert_eq!(found, expected, "{isa}, {threads} threads, scalar {scalar}");
        }
    }
    let expected = falls::<f64>(&people, first, 1, false);
    assert_eq!(falls::<f64>(&people, first, 2, true), expected);
}

/// Joints of many kinds, and everything that acts along them.
#[test]
fn a_mixed_tree_moves_alike_everywhere_by_impulses() {
    few_worlds_agree::<f32>(&mixed(), Method::Impulses, &fused());
    few_worlds_agree::<f64>(&mixed(), Method::Impulses, &fused());
}

#[test]
fn a_large_wall_falls_alike_everywhere() {
    for isas in [fused(), vec![portable()]] {
        let Some(&first) = isas.first() else { continue };
        let expected = a_wall_falls::<f32>(first, 1, false);
        assert_eq!(expected[0], expected[1], "from a snapshot");
        for &isa in &isas {
            for (threads, scalar) in [(2, false), (3, false), (1, true), (2, true)] {
                let found = a_wall_falls::<f32>(isa, threads, scalar);
                assert_eq!(found, expected, "{isa}, {threads} threads, scalar {scalar}");
            }
        }
    }
    let Some(&first) = fused().first() else {
        return;
    };
    let expected = a_wall_falls::<f64>(first, 1, false);
    assert_eq!(a_wall_falls::<f64>(first, 2, true), expected);
}

/// Without fused multiply-add the bits are others, but again the same in all worlds.
#[test]
fn portable_agrees_with_itself() {
    for method in BOTH {
        few_worlds_agree::<f32>(&mixed(), method, &[portable()]);
        few_worlds_agree::<f64>(&mixed(), method, &[portable()]);
    }
    for method in TOUCHING {
        few_worlds_agree::<f32>(&method.heap(), method, &[portable()]);
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
    for method in TOUCHING {
        many_worlds_agree::<f32>(&method.heap(), method);
    }
}

/// The same bits from a simulation that is led otherwise as from one that steps at once.
fn led_otherwise(lead: impl Fn(&mut Simulation<f32>)) {
    let free = METHODS.map(|method| (mixed(), method));
    let touching = TOUCHING.map(|method| (method.heap(), method));
    let jointed = [(mixed(), Method::Impulses)];
    for (model, method) in free.into_iter().chain(touching).chain(jointed) {
        let expected = run::<f32>(&model, method.settings(FEW), |w| w);
        let mut simulation = scattered::<f32>(&model, method.settings(FEW), |w| w);
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

/// What a world keeps to know sooner which shapes are near changes nothing: it moves as one that begins in each of its
/// states with nothing kept.
#[test]
fn what_is_kept_from_step_to_step_changes_nothing() {
    let scenes = [
        model::examples::bowl(60),
        model::examples::ragdolls(3),
        model::examples::rings(6),
    ];
    for model in scenes.map(Result::unwrap) {
        let settings = SimulationSettings {
            solver: SolverKind::Impulse,
            ..SimulationSettings::new(1, 0.004)
        };
        let mut simulation = Simulation::<f32>::new(model.clone(), settings).unwrap();
        for step in 0..250 {
            let mut fresh = Simulation::<f32>::new(model.clone(), settings).unwrap();
            fresh.restore(&simulation.snapshot()).unwrap();
            for world in [&mut fresh, &mut simulation] {
                world.step(1);
            }
            let [fresh, kept] = [&mut fresh, &mut simulation].map(|world| hash(world, 0));
            assert_eq!(fresh, kept, "{}: step {step}", model.name);
        }
    }
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
    let settings = three(method);
    [
        all(run::<f32>(model, settings, |w| w)),
        all(run::<f64>(model, settings, |w| w)),
    ]
}

/// The same of robots that struggle.
fn golden_struggle(model: &Model, method: Method) -> [u64; 2] {
    let settings = three(method);
    [
        all(struggle::<f32>(model, settings, &|w| w)),
        all(struggle::<f64>(model, settings, &|w| w)),
    ]
}

/// One hash of several.
fn all(hashes: Vec<u64>) -> u64 {
    let mixed = |sum: u64, hash: u64| sum.rotate_left(5) ^ hash;
    hashes.into_iter().fold(0, mixed)
}

/// Three worlds.
fn three(method: Method) -> SimulationSettings {
    SimulationSettings {
        isa: Some(Isa::detect()),
        ..method.settings(3)
    }
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
    let found = (
        [mixed(), chain()].map(|model| METHODS.map(|method| golden(&model, method))),
        TOUCHING.map(|method| golden(&method.heap(), method)),
        [Method::Touching, Method::TouchingXpbd].map(|method| golden_struggle(&humanoid(), method)),
    );
    let recorded = (GOLDEN, GOLDEN_HEAP, GOLDEN_HUMANOID);
    assert_eq!(found, recorded, "found:\n{found:#018x?}");
}

/// For the mixed tree and the chain: of each method, f32 and f64.
#[cfg(all(target_arch = "x86_64", target_os = "linux", target_env = "gnu"))]
const GOLDEN: [[[u64; 2]; 5]; 2] = [
    [
        [0x6721_b27b_9116_ba8f, 0xf9b2_fa6c_8ac0_c57b],
        [0x4926_917d_b422_4958, 0x2026_8b3d_5ded_1474],
        [0x9db9_dafd_106d_d880, 0x0f98_db08_54ba_f050],
        [0x6062_6cf5_87fc_594c, 0xc3b5_e2f6_77d7_dcde],
        [0x5c1a_dff0_9b09_f79c, 0x3c01_5b5c_eb6e_c44a],
    ],
    [
        [0x5199_baa6_f627_3aa2, 0x01c1_5bc6_bea1_4176],
        [0xbd15_01ce_f021_c8b1, 0xeb40_2858_ae74_e2ae],
        [0xf7d5_aafa_6bca_e6d3, 0x0217_968a_5386_949e],
        [0x9446_d4cf_b3b7_a17e, 0x3b12_68d7_0551_f66e],
        [0xa998_957d_b78e_c6ba, 0x19ef_4b45_3267_7f48],
    ],
];

/// For the heap: of each method that lets bodies touch, f32 and f64.
#[cfg(all(target_arch = "x86_64", target_os = "linux", target_env = "gnu"))]
const GOLDEN_HEAP: [[u64; 2]; 3] = [
    [0xbbfe_a981_61f5_c421, 0x9fab_6a63_700f_7d41],
    [0x17a1_a5af_08e9_dc72, 0x76fe_4ecb_7294_c4aa],
    [0xd41e_7e23_be0c_bd6e, 0x4b91_9fbe_e8b3_5610],
];

/// For the humanoid that struggles on the ground, by `featherstone` and by `xpbd`, f32 and f64.
#[cfg(all(target_arch = "x86_64", target_os = "linux", target_env = "gnu"))]
const GOLDEN_HUMANOID: [[u64; 2]; 2] = [
    [0x9932_022e_4bad_78fa, 0xd294_eb07_4a91_616a],
    [0x0060_b59b_1103_3824, 0x1076_3940_21a9_1ea9],
];
