//! Steps of the simulation allocate nothing: a longer run allocates larger columns, not more.

use hydrotrace::{
    plant::{Plant, simulate},
    series::{Series, Track},
};

#[test]
fn a_longer_run_allocates_no_more_often() {
    let plant = Plant::preset("default").unwrap();
    let count = |duration_s: f64| {
        let t_s = vec![0.0, duration_s];
        let track = |name: &str| {
            let track = Track::new(name, t_s.clone(), vec![0.9, 1.0], &[]).unwrap();
            track.with_velocity(vec![0.0, 0.0]).unwrap()
        };
        let mut command = Series { tracks: plant.joints().map(track).collect() };
        for track in &mut command.tracks[3..] {
            let home = Track::new(track.name(), t_s.clone(), vec![0.1, 0.2], &[]).unwrap();
            *track = home.with_velocity(vec![0.0, 0.0]).unwrap();
        }
        let mut samples = 0;
        let run = || samples = simulate(&plant, &command, &[], 1).unwrap().t_s.len();
        let info = allocation_counter::measure(run);
        assert!(samples > 100);
        info.count_total
    };
    assert_eq!(count(2.0), count(6.0));
}
