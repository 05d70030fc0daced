//! Torques that a motion needs: the recursive Newton-Euler method (Luh, Walker and Paul 1980,
//! doi:10.1115/1.3149599) for several instants at once.
//!
//! A body's rotation enters through U = [a x] + [w x][w x] of its angular acceleration and speed: a
//! point at r accelerates by U r more than the origin, and the moment of the inertial forces is the
//! antisymmetric part of U J with J the second moment (Balafoutis, Patel and Misra 1988,
//! doi:10.1109/56.9304). Sums and products are not fused, so that every machine finds the same bits.

use multiversion::multiversion;

use super::{
    Chain, GRAVITY_M_S2, Inertia,
    chain::{Load, Step},
};
use crate::math::sin_cos;

/// The number of instants that suits the widest vector units.
pub const LANES: usize = 8;

/// Motion of the joints, by joint and then by instant; the slices have an entry a joint. Of one that slides read m for rad.
#[derive(Debug, Clone, Copy)]
pub struct Motion<'a, const L: usize> {
    /// Angles, rad.
    pub position_rad: &'a [[f64; L]],
    /// Speeds, rad/s.
    pub speed_rad_s: &'a [[f64; L]],
    /// Accelerations, rad/s².
    pub acceleration_rad_s2: &'a [[f64; L]],
}

type Vectors<const L: usize> = [[f64; L]; 3];

#[derive(Debug, Clone, Copy)]
struct Body<const L: usize> {
    sin: [f64; L],
    cos: [f64; L],
    /// How far a joint that slides has slid, m; of one that turns void.
    slid: [f64; L],
    speed: Vectors<L>,
    acceleration: Vectors<L>,
    /// Acceleration of the next joint's origin.
    reach: Vectors<L>,
    force: Vectors<L>,
    moment: Vectors<L>,
}

/// Memory that [`Chain::inverse_dynamics`] works in; one a thread.
#[derive(Debug, Clone)]
pub struct Workspace<const L: usize> {
    bodies: Vec<Body<L>>,
}

impl<const L: usize> Workspace<L> {
    /// Memory for a chain.
    pub fn new(chain: &Chain) -> Self {
        let zero = [[0.0; L]; 3];
        let body = Body {
            sin: [0.0; L],
            cos: [1.0; L],
            slid: [0.0; L],
            speed: zero,
            acceleration: zero,
            reach: zero,
            force: zero,
            moment: zero,
        };
        Self { bodies: vec![body; chain.joint_count()] }
    }

    /// Sines and cosines of the angles last given, by joint; 0 and 1 of one that slides.
    pub fn sin_cos(&self) -> impl Iterator<Item = (&[f64; L], &[f64; L])> {
        self.bodies.iter().map(|body| (&body.sin, &body.cos))
    }
}

impl Chain {
    /// Torques in N m, forces in N of joints that slide, that move the joints as asked, by joint and instant, against gravity along
    /// minus z of the base.
    ///
    /// Takes the widest vector unit of the processor; the result does not depend on which. Joints
    /// that a slice has no entry for are left out, with all beyond them.
    pub fn inverse_dynamics<const L: usize>(
        &self,
        load: &Load,
        motion: Motion<'_, L>,
        work: &mut Workspace<L>,
        torque_nm: &mut [[f64; L]],
    ) {
        dispatched(self, load, motion, work, torque_nm);
    }
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn dispatched<const L: usize>(
    chain: &Chain,
    load: &Load,
    motion: Motion<'_, L>,
    work: &mut Workspace<L>,
    torque_nm: &mut [[f64; L]],
) {
    inverse_dynamics(chain, load, motion, work, torque_nm);
}

/// As [`Chain::inverse_dynamics`], with the vector unit of the function that it is called from.
#[inline(always)]
pub fn inverse_dynamics<const L: usize>(
    chain: &Chain,
    load: &Load,
    motion: Motion<'_, L>,
    work: &mut Workspace<L>,
    torque_nm: &mut [[f64; L]],
) {
    let joints = chain.steps.len().min(work.bodies.len()).min(torque_nm.len());
    let joints = joints.min(motion.position_rad.len()).min(motion.speed_rad_s.len());
    let joints = joints.min(motion.acceleration_rad_s2.len());
    // The base accelerates upwards instead of the bodies being pulled down.
    let zero = [[0.0; L]; 3];
    let (mut speed, mut acceleration) = (zero, zero);
    let mut reach = [[0.0; L], [0.0; L], [GRAVITY_M_S2; L]];
    // None waits for another, so these come first.
    let bodies = work.bodies[..joints].iter_mut().zip(&chain.steps);
    for ((body, step), position) in bodies.zip(motion.position_rad) {
        if step.slides {
            body.slid = *position;
        } else {
            (body.sin, body.cos) = sin_cos(position);
        }
    }
    for i in 0..joints {
        let body = &mut work.bodies[i];
        let inertia = if i + 1 == chain.steps.len() { &load.0 } else { &chain.bodies[i] };
        let onwards = chain.steps.get(i + 1).map_or([0.0; 3], |next| next.offset_m.into());
        let rates = (&motion.speed_rad_s[i], &motion.acceleration_rad_s2[i]);
        let (step, before) = (&chain.steps[i], (&speed, &acceleration, &reach));
        if step.slides {
            outwards::<L, true>(step, inertia, onwards, rates, before, body);
        } else {
            outwards::<L, false>(step, inertia, onwards, rates, before, body);
        }
        (speed, acceleration, reach) = (body.speed, body.acceleration, body.reach);
    }
    for i in (0..joints).rev() {
        let (step, body) = (&chain.steps[i], &work.bodies[i]);
        torque_nm[i] = if step.slides { body.force[2] } else { body.moment[2] };
        if let (inner, [outer, ..]) = work.bodies.split_at_mut(i)
            && let Some(inner) = inner.last_mut()
        {
            if step.slides {
                inwards::<L, true>(step, outer, inner);
            } else {
                inwards::<L, false>(step, outer, inner);
            }
        }
    }
}

/// Motion of a body from that of the body before it, and what it takes to move it.
#[inline(always)]
fn outwards<const L: usize, const SLIDES: bool>(
    step: &Step,
    inertia: &Inertia,
    onwards: [f64; 3],
    (rate, rate_change): (&[f64; L], &[f64; L]),
    (speed, acceleration, reach): (&Vectors<L>, &Vectors<L>, &Vectors<L>),
    body: &mut Body<L>,
) {
    let columns: [[f64; 3]; 3] = step.rotation.into();
    let mass = inertia.mass_kg();
    let first: [f64; 3] = (*inertia.first_kg_m()).into();
    let second: [[f64; 3]; 3] = (*inertia.second_kg_m2()).into();
    // Loops over components within this one would keep it from becoming vector code.
    for l in 0..L {
        let (sin, cos) = (body.sin[l], body.cos[l]);
        let into = |v: &Vectors<L>| {
            let [x, y, z] = times(&columns, at(v, l));
            [cos * x + sin * y, cos * y - sin * x, z]
        };
        let (mut w, mut b, mut a) = (into(speed), into(acceleration), into(reach));
        if !SLIDES {
            b = [b[0] + w[1] * rate[l], b[1] - w[0] * rate[l], b[2] + rate_change[l]];
            w = [w[0], w[1], w[2] + rate[l]];
        }
        let (xx, yy, zz) = (w[0] * w[0], w[1] * w[1], w[2] * w[2]);
        let (xy, xz, yz) = (w[0] * w[1], w[0] * w[2], w[1] * w[2]);
        let u = [
            [-(yy + zz), xy - b[2], xz + b[1]],
            [xy + b[2], -(xx + zz), yz - b[0]],
            [xz - b[1], yz + b[0], -(xx + yy)],
        ];
        if SLIDES {
            // The origin has slid along z, with Coriolis' acceleration.
            let slid = body.slid[l];
            a = [
                a[0] + u[0][2] * slid + 2.0 * w[1] * rate[l],
                a[1] + u[1][2] * slid - 2.0 * w[0] * rate[l],
                a[2] + u[2][2] * slid + rate_change[l],
            ];
        }
        let uj = [times(&u, second[0]), times(&u, second[1]), times(&u, second[2])];
        let turning = [uj[1][2] - uj[2][1], uj[2][0] - uj[0][2], uj[0][1] - uj[1][0]];
        set(&mut body.speed, l, w);
        set(&mut body.acceleration, l, b);
        set(&mut body.reach, l, sum(a, times(&u, onwards)));
        set(&mut body.force, l, sum([mass * a[0], mass * a[1], mass * a[2]], times(&u, first)));
        set(&mut body.moment, l, sum(turning, cross(first, a)));
    }
}

/// Hands the load of a body to the body before it.
#[inline(always)]
fn inwards<const L: usize, const SLIDES: bool>(step: &Step, outer: &Body<L>, inner: &mut Body<L>) {
    let rows: [[f64; 3]; 3] = step.rotation.transpose().into();
    let offset: [f64; 3] = step.offset_m.into();
    for l in 0..L {
        let (sin, cos) = (outer.sin[l], outer.cos[l]);
        let out_of = |v: &Vectors<L>| {
            let [x, y, z] = at(v, l);
            times(&rows, [cos * x - sin * y, sin * x + cos * y, z])
        };
        let (force, moment) = (out_of(&outer.force), out_of(&outer.moment));
        let mut arm = offset;
        if SLIDES {
            let slid = outer.slid[l];
            arm =
                [offset[0] + rows[0][2] * slid, offset[1] + rows[1][2] * slid, offset[2] + rows[2][2] * slid];
        }
        let moment = sum(moment, cross(arm, force));
        let (own_force, own_moment) = (at(&inner.force, l), at(&inner.moment, l));
        set(&mut inner.force, l, sum(own_force, force));
        set(&mut inner.moment, l, sum(own_moment, moment));
    }
}

#[inline(always)]
fn at<const L: usize>(v: &Vectors<L>, lane: usize) -> [f64; 3] {
    [v[0][lane], v[1][lane], v[2][lane]]
}

#[inline(always)]
fn set<const L: usize>(v: &mut Vectors<L>, lane: usize, to: [f64; 3]) {
    (v[0][lane], v[1][lane], v[2][lane]) = (to[0], to[1], to[2]);
}

#[inline(always)]
fn sum(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Product of a matrix, by rows, and a vector.
#[inline(always)]
fn times(rows: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    let dot = |a: [f64; 3]| a[0] * v[0] + a[1] * v[1] + a[2] * v[2];
    [dot(rows[0]), dot(rows[1]), dot(rows[2])]
}
