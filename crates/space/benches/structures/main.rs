//! Every structure, and two peers, over 10² … 10⁶ objects.
//!
//! `cargo bench -p kinetarium-space` runs all; `-- 4` stops at 10⁴ objects.
//! Each figure is a median; answers are counted, and must agree.

mod measure;
mod peers;
mod scene;
mod subject;

use kinetarium_space::{Bsp, Bvh, Grid, KdTree, Octree, Space, SweepAndPrune};
use measure::{Row, Table};
use scene::Scene;

fn main() {
    let largest = std::env::args().find_map(|a| a.parse().ok()).unwrap_or(6);
    for kind in [scene::Kind::Uniform, scene::Kind::Clustered] {
        let mut table = Table::default();
        for exponent in 2..=largest {
            let scene = Scene::new(kind, 10_usize.pow(exponent));
            table.start(&scene);
            table.add::<Space<Bvh>>(&scene);
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
}
