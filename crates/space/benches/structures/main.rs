//! Every structure, and two peers, over 10² … 10⁶ objects.
//!
//! `cargo bench -p kinetarium-space` runs all; `-- 4 bvh` stops at 10⁴ objects and
//! takes structures with `bvh` in their name only.
//! Each figure is the median of its repetitions; answers are counted, and must agree.

mod measure;
mod peers;
mod replicas;
mod scene;
mod subject;

use kinetarium_space::{Auto, Bsp, Bvh, Grid, KdTree, Octree, Space, SweepAndPrune};
use measure::{Row, Table};
use scene::Scene;

fn main() {
    let arguments: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| !a.starts_with('-'))
        .collect();
    let largest = arguments.iter().find_map(|a| a.parse().ok()).unwrap_or(6);
    let filter = arguments
        .into_iter()
        .find(|a| a.parse::<u32>().is_err())
        .unwrap_or_default();
    for kind in [scene::Kind::Uniform, scene::Kind::Clustered] {
        let mut table = Table::new(&filter);
        for exponent in 2..=largest {
            let scene = Scene::new(kind, 10_usize.pow(exponent));
            table.start(&scene);
            table.add::<Space<Bvh>>(&scene);
            table.add::<Space<Auto>>(&scene);
            table.add::<Space<SweepAndPrune>>(&scene);
            table.add::<Space<Grid>>(&scene);
            table.add::<Space<Octree>>(&scene);
            table.add::<Space<KdTree>>(&scene);
            table.add::<Space<Bsp>>(&scene);
            table.add::<peers::Parry>(&scene);
            table.add::<peers::Rstar>(&scene);
        }
    }
    println!("\n{}", Row::LEGEND);
    replicas::run();
}
