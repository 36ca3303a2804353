//! Layouts that are counted in one process, against ranks that really exchange.

mod common;

use common::{Cloud, random};
use sph_decomp::scale::{Layout, Point, RankLoad};
use sph_decomp::{
    Communicator, MaxReach, Orb, Partition, Parts, Reach, ThreadRanks, Zone, ZoneOptions, migrate,
};

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// What ranks hold after a rebuild: local, inner and outer active particles, and outer passive ones.
fn run(positions: &[[f64; 3]], points: &[Point], ranks: usize, reach: f64) -> Vec<[usize; 4]> {
    let result = ThreadRanks::run(ranks, |comm| {
        let mine: Vec<usize> = (0..points.len()).filter(|i| i % ranks == comm.rank()).collect();
        let mut x: Vec<_> = mine.iter().map(|&i| positions[i]).collect();
        let mut active: Vec<u8> = mine.iter().map(|&i| u8::from(points[i].active)).collect();
        let costs: Vec<f64> = mine.iter().map(|&i| f64::from(points[i].cost)).collect();
        let owners = Orb::build(&comm, &x, &costs)?.owners(&x);
        migrate(&comm, &owners, &mut (&mut x, &mut active))?;
        let zone =
            Zone::build(&comm, &x, Reach::Uniform(reach), MaxReach, &ZoneOptions::default())?;
        let plan = zone.into_plan(&comm)?;
        let inner = plan.is_inner(x.len());
        let mut halo = sph_decomp::Halo::<u8>::new();
        let outer = halo.exchange_now(&comm, &plan, |i| active[i as usize])?.to_vec();
        let (parts, _) = Parts::arrange(x.len(), &plan, |i| i);
        assert_eq!(parts.outer, outer.len());
        let count = |is_inner: bool| {
            (0..x.len()).filter(|&i| active[i] == 1 && inner[i] == is_inner).count()
        };
        let near = outer.iter().filter(|&&one| one == 1).count();
        Ok::<_, Failure>([count(false), count(true), near, outer.len() - near])
    });
    result.unwrap()
}

#[test]
fn one_process_counts_what_ranks_hold() {
    // On a lattice many coordinates are equal, in the jittered one none.
    for (jitter, seed) in [(0.0, 3), (0.3, 4)] {
        let cloud = Cloud::<3>::lattice(14, 0.1, jitter, 1.0, seed);
        let mut random = random(seed);
        let points: Vec<Point> = cloud
            .positions
            .iter()
            .map(|x| {
                let active = x[2] > 0.35;
                let cost = if active { 100.0 + (20.0 * random()).floor() } else { 4.0 };
                Point { active, cost: cost as f32, pairs: 1.0 }
            })
            .collect();
        for ranks in [1, 2, 3, 8] {
            let expected = run(&cloud.positions, &points, ranks, 0.33);
            let (mut x, mut p) = (cloud.positions.clone(), points.clone());
            let layout =
                Layout::of_points(ranks, &mut x, &mut p, 0.33, &ZoneOptions::default()).unwrap();
            let counted = |load: &RankLoad| {
                [load.local, load.inner, load.outer, load.outer_passive].map(|n| n as usize)
            };
            let counted: Vec<_> = layout.ranks.iter().map(counted).collect();
            assert_eq!(counted, expected, "{ranks} ranks, jitter {jitter}");
            // What is sent arrives, and nothing is computed twice.
            assert_eq!(layout.sum(|load| load.sent), layout.sum(|load| load.outer));
            let active = points.iter().filter(|point| point.active).count();
            assert_eq!(layout.sum(RankLoad::pairs), active as f64);
        }
    }
}

#[test]
fn more_ranks_than_particles_are_refused() {
    let error =
        Layout::of_points(3, &mut [[0.0]], &mut [Point::default()], 1.0, &ZoneOptions::default());
    assert!(error.unwrap_err().to_string().contains("3 ranks cannot share 1 particles"));
}
