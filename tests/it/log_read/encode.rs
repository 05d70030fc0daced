//! Messages of the types that carry joints.

use super::cdr::{Cdr, Kind};

pub(crate) fn joint_state(
    kind: Kind,
    ns: i64,
    names: &[&str],
    position: &[f64],
    velocity: &[f64],
) -> Vec<u8> {
    Cdr::message(kind, |cdr| {
        cdr.header(ns);
        cdr.texts(names);
        cdr.f64s(position);
        cdr.f64s(velocity);
        cdr.f64s(&[]);
    })
}

#[derive(Debug, Clone, Default)]
pub(crate) struct Point {
    pub(crate) position: Vec<f64>,
    pub(crate) velocity: Vec<f64>,
    pub(crate) acceleration: Vec<f64>,
    pub(crate) since_ns: i64,
}

impl Point {
    pub(crate) fn at(position: &[f64]) -> Self {
        Self { position: position.to_vec(), ..Self::default() }
    }

    pub(crate) fn write(&self, cdr: &mut Cdr) {
        cdr.record(|cdr| {
            cdr.f64s(&self.position);
            cdr.f64s(&self.velocity);
            cdr.f64s(&self.acceleration);
            cdr.f64s(&[]);
            cdr.time(self.since_ns);
        });
    }
}

/// A `MultiDOFJointTrajectoryPoint` with one transform, so that its bytes count.
fn multi_dof(cdr: &mut Cdr) {
    cdr.record(|cdr| {
        cdr.list(&[()], |cdr, ()| {
            cdr.record(|cdr| {
                cdr.record(|cdr| (0..3).for_each(|k| cdr.f64(f64::from(k))));
                cdr.record(|cdr| (0..4).for_each(|k| cdr.f64(f64::from(k))));
            });
        });
        cdr.list::<()>(&[], |_, ()| {});
        cdr.list::<()>(&[], |_, ()| {});
        cdr.time(0);
    });
}

pub(crate) fn controller_state(
    kind: Kind,
    ns: i64,
    names: &[&str],
    points: &[Point],
    with_multi_dof: bool,
    speed_scaling: Option<f64>,
) -> Vec<u8> {
    Cdr::message(kind, |cdr| {
        cdr.header(ns);
        cdr.texts(names);
        points.iter().for_each(|point| point.write(cdr));
        if with_multi_dof {
            cdr.texts(&["floating"]);
            points.iter().for_each(|_| multi_dof(cdr));
        }
        if let Some(factor) = speed_scaling {
            cdr.f64(factor);
        }
    })
}

/// The fields of `trajectory_msgs/JointTrajectory`, without a size of the struct.
pub(crate) fn trajectory_fields(cdr: &mut Cdr, ns: i64, names: &[&str], points: &[Point]) {
    cdr.header(ns);
    cdr.texts(names);
    cdr.list(points, |cdr, point| point.write(cdr));
}

pub(crate) fn trajectory(kind: Kind, ns: i64, names: &[&str], points: &[Point]) -> Vec<u8> {
    Cdr::message(kind, |cdr| trajectory_fields(cdr, ns, names, points))
}

/// `moveit_msgs/DisplayTrajectory` of several trajectories.
pub(crate) fn robot_trajectory(kind: Kind, trajectory: &(i64, &[&str], Vec<Point>)) -> Vec<u8> {
    Cdr::message(kind, |cdr| robot_fields(cdr, trajectory))
}

fn robot_fields(cdr: &mut Cdr, (ns, names, points): &(i64, &[&str], Vec<Point>)) {
    cdr.record(|cdr| trajectory_fields(cdr, *ns, names, points));
    cdr.record(|cdr| {
        cdr.header(0);
        cdr.texts(&["floating"]);
        cdr.list(&[()], |cdr, ()| multi_dof(cdr));
    });
}

pub(crate) fn display(kind: Kind, trajectories: &[(i64, &[&str], Vec<Point>)]) -> Vec<u8> {
    Cdr::message(kind, |cdr| {
        cdr.text("arm");
        cdr.list(trajectories, |cdr, trajectory| cdr.record(|cdr| robot_fields(cdr, trajectory)));
        cdr.record(|cdr| {
            cdr.record(|cdr| {
                cdr.header(0);
                cdr.texts(&["a", "b", "other"]);
                cdr.f64s(&[9.0, 9.0, 9.0]);
                cdr.f64s(&[]);
                cdr.f64s(&[]);
            });
            cdr.record(|cdr| {
                cdr.header(0);
                cdr.texts(&[]);
                (0..3).for_each(|_| cdr.list::<()>(&[], |_, ()| {}));
            });
            cdr.u8(0);
        });
    })
}

pub(crate) fn dynamic(kind: Kind, ns: i64, joints: &[(&str, &[(&str, f64)])]) -> Vec<u8> {
    Cdr::message(kind, |cdr| {
        cdr.header(ns);
        cdr.texts(&joints.iter().map(|(name, _)| *name).collect::<Vec<_>>());
        cdr.list(joints, |cdr, (_, interfaces)| {
            cdr.record(|cdr| {
                cdr.texts(&interfaces.iter().map(|(name, _)| *name).collect::<Vec<_>>());
                cdr.f64s(&interfaces.iter().map(|(_, value)| *value).collect::<Vec<_>>());
            });
        });
    })
}

pub(crate) fn array(kind: Kind, data: &[f64]) -> Vec<u8> {
    Cdr::message(kind, |cdr| {
        cdr.record(|cdr| {
            cdr.list(&["joints"], |cdr, label| {
                cdr.record(|cdr| {
                    cdr.text(label);
                    cdr.u32(2);
                    cdr.u32(2);
                });
            });
            cdr.u32(0);
        });
        cdr.f64s(data);
    })
}
