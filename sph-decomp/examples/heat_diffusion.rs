//! Heat spreads over scattered points of graded density, on ranks that are threads.
//!
//! Each point exchanges heat with all points within the mean of their two reaches. The points do
//! not move, so partition, zone and plan are made once, and every step is one overlapped pass in
//! the order of the local–inner–outer scheme: inner points first, then local ones while the inner
//! ones travel. The result has the same bits on any number of ranks.
//!
//! `cargo run --release --example heat_diffusion`

use std::error::Error;

use sph_decomp::{
    Columns, Communicator, ExactSum, Halo, MeanReach, Orb, Partition, Parts, RankStatistics, Reach,
    ThreadRanks, Zone, ZoneOptions, global_sums, migrate,
};

type Failure = Box<dyn Error + Send + Sync>;

const STEPS: usize = 200;

/// Points of a spiral, dense at the centre, and how far each one sees.
fn points() -> (Vec<[f64; 2]>, Vec<f64>) {
    let point = |k: usize| {
        let (radius, angle) = (0.01 * (k as f64).powf(0.75), 2.399_963 * k as f64);
        ([radius * angle.cos(), radius * angle.sin()], 0.01 + 0.28 * radius.powf(1.0 / 3.0))
    };
    (0..4000).map(point).unzip()
}

/// What all ranks find, and what one rank spent.
struct Report {
    heat: [f64; 2],
    hottest: f64,
    statistics: RankStatistics,
}

fn diffuse<C: Communicator>(comm: &C) -> Result<Report, Failure> {
    // Rank 0 makes the points. Every other rank starts with none.
    let (mut positions, mut reach) = if comm.rank() == 0 { points() } else { Default::default() };
    let mut ids: Vec<u64> = (0..positions.len() as u64).collect();

    // Who owns what, and who needs what of it.
    let owners = Orb::build(comm, &positions, &[])?.owners(&positions);
    migrate(comm, &owners, &mut (&mut ids, &mut positions, &mut reach))?;
    let (sees, options) = (Reach::PerParticle(&reach), ZoneOptions::default());
    let mut plan = Zone::build(comm, &positions, sees, MeanReach, &options)?.into_plan(comm)?;

    // The order [local | inner | outer].
    let (parts, order) = Parts::arrange(ids.len(), &plan, |i| ids[i as usize]);
    (&mut ids, &mut positions, &mut reach).permute(&order);
    plan.renumber_owned(&order);
    let mut setup = Halo::<[f64; 4]>::new();
    let outer = setup.exchange_now(comm, &plan, |i| {
        let i = i as usize;
        [ids[i] as f64, positions[i][0], positions[i][1], reach[i]]
    })?;
    for [id, x, y, r] in outer {
        ids.push(*id as u64);
        positions.push([*x, *y]);
        reach.push(*r);
    }

    let neighbours = neighbours(&ids, &positions, &reach, parts.owned());
    let mut heat: Vec<f64> = positions.iter().map(|x| f64::from(x[0].abs() < 0.3)).collect();
    let total = |heat: &[f64]| heat[..parts.owned()].iter().copied().collect::<ExactSum>();
    let start = total(&heat);

    let mut halo = Halo::<f64>::new();
    let mut statistics = RankStatistics::default();
    statistics.layout(comm, &parts, &plan);
    let mut next = heat.clone();
    let mut hottest = [0.0];
    for _ in 0..STEPS {
        let updated = |i: usize| {
            let gained =
                neighbours[i].iter().map(|&(j, weight)| weight * (heat[j as usize] - heat[i]));
            heat[i] + gained.sum::<f64>()
        };
        hottest[0] = heat[..parts.owned()].iter().copied().fold(0.0, f64::max);
        let (next_local, next_inner, _) = parts.split_mut(&mut next);
        let (received, exposed) = halo.exchange(
            comm,
            &plan,
            &mut hottest,
            |send| {
                for (next, i) in next_inner.iter_mut().zip(parts.inner_range()) {
                    *next = updated(i);
                }
                plan.pack(send, |i| next_inner[i as usize - parts.local]);
            },
            |progress| {
                for (next, i) in next_local.iter_mut().zip(parts.local_range()) {
                    *next = updated(i);
                    if i % 256 == 0 {
                        progress.poll();
                    }
                }
            },
        )?;
        plan.unpack(received, |slot, value| next[parts.owned() + slot] = *value);
        statistics.pass(&exposed);
        std::mem::swap(&mut heat, &mut next);
    }
    let sums = global_sums(comm, &[start, total(&heat)])?;
    Ok(Report { heat: [sums[0], sums[1]], hottest: hottest[0], statistics })
}

/// For each owned point its neighbours by ascending id, and the share of heat they exchange.
fn neighbours(
    ids: &[u64],
    positions: &[[f64; 2]],
    reach: &[f64],
    owned: usize,
) -> Vec<Vec<(u32, f64)>> {
    let mut by_id: Vec<u32> = (0..ids.len() as u32).collect();
    by_id.sort_by_key(|&i| ids[i as usize]);
    let exchanged = |i: usize, j: usize| {
        let mean = 0.5 * (reach[i] + reach[j]);
        let d = [positions[i][0] - positions[j][0], positions[i][1] - positions[j][1]];
        let q = (d[0] * d[0] + d[1] * d[1]).sqrt() / mean;
        (i != j && q < 1.0).then(|| 0.1 * (1.0 - q).powi(2))
    };
    let list = |i: usize| {
        by_id.iter().filter_map(|&j| exchanged(i, j as usize).map(|weight| (j, weight))).collect()
    };
    (0..owned).map(list).collect()
}

fn main() -> Result<(), Failure> {
    let mut first: Option<Report> = None;
    for ranks in [1, 2, 5] {
        println!("{ranks} ranks");
        for report in ThreadRanks::run(ranks, |comm| diffuse(&comm)).map_err(|e| e.to_string())? {
            let RankStatistics { rank, local, inner, outer, exposed_seconds, .. } =
                report.statistics;
            print!("  rank {rank}: {local} local, {inner} inner, {outer} outer, ");
            println!("{exposed_seconds:.4} s exposed, heat {:?}", report.heat);
            let one = first.get_or_insert(Report { ..report });
            assert_eq!((one.heat, one.hottest), (report.heat, report.hottest), "the same bits");
            assert!((report.heat[1] / report.heat[0] - 1.0).abs() < 1e-12, "heat is conserved");
            assert!(report.hottest < 1.0, "heat spreads");
        }
    }
    Ok(())
}
