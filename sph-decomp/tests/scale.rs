//! Layouts that are counted in one process, against ranks that really exchange.

mod common;

use common::{Cloud, random};
use sph_decomp::scale::{Layout, Point, RankLoad};
use sph_decomp::{
    Askew, Communicator, MaxReach, Orb, Partition, Parts, Reach, ThreadRanks, Zone, ZoneOptions,
    migrate,
};

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// What ranks hold after a rebuild: local, inner and outer active particles, and passive ones.
fn run(positions: &[[f64; 3]], points: &[Point], ranks: usize, reach: f64) -> Vec<[usize; 4]> {
    let result = ThreadRanks::run(ranks, |comm| {
        let mine: Vec<usize> = (0..points.len()).filter(|i| i % ranks == comm.rank()).collect();
        let mut x: Vec<_> = mine.iter().map(|&i| positions[i]).collect();
        let mut active: Vec<u8> = mine.iter().map(|&i| u8::from(points[i].active)).collect();
        let costs: Vec<f64> = mine.iter().map(|&i| f64::from(points[i].cost)).collect();
        let orb = Orb::build(&comm, &Askew::view(&x), &costs)?;
        let owners = Askew::new(orb).owners(&x);
        migrate(&comm, &owners, &mut (&mut x, &mut active))?;
        let owned = x.len();
        let mut flags = active.iter();
        x.retain(|_| flags.next() == Some(&1));
        let zone =
            Zone::build(&comm, &x, Reach::Uniform(reach), MaxReach, &ZoneOptions::default())?;
        let plan = zone.into_plan(&comm)?;
        let mut halo = sph_decomp::Halo::<u8>::new();
        let outer = halo.exchange_now(&comm, &plan, |_| 1)?.len();
        let (parts, _) = Parts::arrange(x.len(), &plan, |i| i);
        assert_eq!(parts.outer, outer);
        Ok::<_, Failure>([parts.local, parts.inner, parts.outer, owned - x.len()])
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
                [load.local, load.inner, load.outer, load.passive].map(|n| n as usize)
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
fn passive_particles_are_needed_where_active_ones_are_near() {
    // A floor along all of it, water on the left half only; ranks side by side.
    let at = |i: i32, j: i32| [f64::from(i), f64::from(j)];
    let floor = (0..40).map(|i| (at(i, -1), false));
    let water = (0..20).flat_map(|i| (0..4).map(move |j| (at(i, j), true)));
    let all: Vec<([f64; 2], bool)> = floor.chain(water).collect();
    let reach = 2.5;
    for ranks in [2, 3, 5] {
        let mut x: Vec<[f64; 2]> = all.iter().map(|one| one.0).collect();
        let mut points: Vec<Point> = all
            .iter()
            .map(|&(_, active)| Point { active, cost: if active { 2.0 } else { 0.5 }, pairs: 1.0 })
            .collect();
        let options = ZoneOptions { block: 1, ..ZoneOptions::default() };
        let layout = Layout::of_points(ranks, &mut x, &mut points, reach, &options).unwrap();
        let mut start = 0;
        for load in &layout.ranks {
            let end = start + (load.active() + load.passive) as usize;
            let near = |i: &usize| {
                let d2 = |j: usize| (x[*i][0] - x[j][0]).powi(2) + (x[*i][1] - x[j][1]).powi(2);
                (start..end).any(|j| points[j].active && d2(j) < reach * reach)
            };
            let others = (0..x.len()).filter(|i| !(start..end).contains(i));
            let needed: Vec<usize> = others.filter(near).collect();
            let passive = needed.iter().filter(|&&i| !points[i].active).count() as f64;
            assert_eq!((load.outer_passive, load.repeated_pairs), (passive, passive));
            assert_eq!(load.outer, needed.len() as f64 - passive);
            start = end;
        }
        assert!(layout.sum(|load| load.outer_passive) > 0.0);
    }
}

#[test]
fn more_ranks_than_particles_are_refused() {
    let error =
        Layout::of_points(3, &mut [[0.0]], &mut [Point::default()], 1.0, &ZoneOptions::default());
    assert!(error.unwrap_err().to_string().contains("3 ranks cannot share 1 particles"));
}
