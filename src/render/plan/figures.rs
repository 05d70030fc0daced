//! The plots of a plan one by one.

use super::{front::front_charts, motion::motion_charts};
use crate::{
    render::kit::{
        Failure, Figure,
        figure::{figure, numbered},
    },
    workflow::plan::{Course, PlanDocument},
};

/// The plots of a search and of the motion it chose.
pub(crate) fn figures(plan: &PlanDocument, course: &Course) -> Result<Vec<Figure>, Failure> {
    let mut figures = front_figures(plan)?;
    figures.extend(motion_figures(&plan.joints, course)?);
    Ok(figures)
}

pub(crate) fn motion_figures(joints: &[String], course: &Course) -> Result<Vec<Figure>, Failure> {
    numbered("motion", &motion_charts(joints, course))
}

pub(in crate::render) fn front_figures(front: &PlanDocument) -> Result<Vec<Figure>, Failure> {
    front_charts(front).into_iter().map(|(name, chart)| figure(&name, &chart)).collect()
}
