//! Evaluating other times of the same plan allocates nothing.

use hydrotrace::spline::{Degree, Dwell, Ends, Gauss, KeyPoints, Motion, Quantity, Samples};

#[test]
fn new_times_jerk_nodes_states_and_extrema_allocate_nothing_once_buffers_have_grown() {
    let points = KeyPoints::new(2, (0..14).map(f64::from).collect()).unwrap();
    let dwell = Dwell { point: 3, length_s: 0.5 };
    let t_s = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    let mut motion = Motion::new(Degree::Sextic, points, &Ends::at_rest(2), &[dwell], &t_s).unwrap();
    let (mut nodes_s, mut weights_s, mut samples) = (Vec::new(), Vec::new(), Samples::default());
    let mut rms = [0.0; 2];
    let mut evaluate = |stretch: f64| {
        motion.retime(&t_s.map(|t| t * stretch)).unwrap();
        motion.rms_jerk(&mut rms);
        for segment in motion.segments() {
            nodes_s.clear();
            weights_s.clear();
            segment.spline.quadrature(Gauss::Eight, 1, &mut nodes_s, &mut weights_s);
            segment.spline.sample(&nodes_s, Quantity::Acceleration, &mut samples);
        }
        motion.extrema(0, Quantity::Velocity).peak().value
    };
    let first = evaluate(1.0);
    let mut second = first;
    let info = allocation_counter::measure(|| second = evaluate(2.0));
    assert!(second < first);
    assert_eq!(info.count_total, 0, "{info:?}");
}
