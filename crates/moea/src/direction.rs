//! Reference directions on the unit simplex.

use rayon::prelude::*;

use super::error::{MoeaError, Unsound};

/// More directions than this are refused: a population of that size cannot be meant.
pub const MOST_DIRECTIONS: usize = 100_000;

/// More objectives than this are refused.
pub(super) const MOST_OBJECTIVES: usize = 1000;

/// Where the reference directions come from.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Directions {
    /// As Deb and Jain 2014, table I, choose for each number of objectives.
    #[default]
    Usual,
    /// As many as fit into the population size of the settings.
    FromPopulation,
    /// Das and Dennis 1998: every combination of multiples of 1/p that adds up to one.
    Divisions(usize),
    /// An outer layer of the first number of divisions and an inner one, shrunk by a half
    /// towards the centre, of the second.
    Layers(usize, usize),
    /// Directions of the caller's, `[objectives]` each: no value below 0, not all of them 0, in
    /// normalised objectives, of any length. Where only part of the front matters, or some of it more
    /// than the rest.
    Own(Vec<Vec<f64>>),
}

/// Number of directions of `divisions` for `objectives`: C(m + p - 1, p), eq. 7; `None` when
/// it is beyond [`MOST_DIRECTIONS`].
pub fn direction_count(objectives: usize, divisions: usize) -> Option<usize> {
    if divisions == 0 || objectives == 0 {
        return Some(objectives.min(1));
    }
    let mut count: u128 = 1;
    for k in 1..objectives {
        count = count.checked_mul(divisions as u128 + k as u128)? / k as u128;
        if count > MOST_DIRECTIONS as u128 {
            return None;
        }
    }
    usize::try_from(count).ok()
}

/// The directions, `[count][objectives]` in one vector, each adding up to one, in
/// lexicographic order.
///
/// # Errors
///
/// [`MoeaError::TooManyDirections`] beyond [`MOST_DIRECTIONS`], [`MoeaError::TooManyObjectives`] beyond 1000.
pub fn das_dennis(objectives: usize, divisions: usize) -> Result<Vec<f64>, MoeaError> {
    if objectives > MOST_OBJECTIVES {
        return Err(MoeaError::TooManyObjectives { objectives, most: MOST_OBJECTIVES });
    }
    let too_many = MoeaError::TooManyDirections { objectives, divisions, most: MOST_DIRECTIONS };
    let count = direction_count(objectives, divisions).ok_or(too_many)?;
    let mut flat = Vec::with_capacity(count * objectives);
    if objectives == 0 {
        return Ok(flat);
    }
    if divisions == 0 {
        return Ok(vec![1.0 / objectives as f64; objectives]);
    }
    // Parts of `divisions`, counted like an odometer: the last part takes what is left.
    let mut parts = vec![0usize; objectives];
    parts[objectives - 1] = divisions;
    loop {
        flat.extend(parts.iter().map(|&part| part as f64 / divisions as f64));
        let rest = parts[objectives - 1];
        parts[objectives - 1] = 0;
        let Some(place) = (0..objectives - 1).rev().find(|&k| rest > 0 || parts[k] > 0) else { break };
        if rest > 0 {
            parts[place] += 1;
            parts[objectives - 1] = rest - 1;
        } else {
            let carried = parts[place];
            if place == 0 {
                break;
            }
            parts[place] = 0;
            parts[place - 1] += 1;
            parts[objectives - 1] = carried - 1;
        }
    }
    Ok(flat)
}

impl Directions {
    /// The directions for `objectives`, `[count][objectives]`; `wanted` is the population size
    /// to fit into.
    ///
    /// # Errors
    ///
    /// [`MoeaError::TooManyDirections`] beyond [`MOST_DIRECTIONS`], [`MoeaError::TooManyObjectives`] beyond 1000;
    /// [`MoeaError::Direction`] and
    /// [`MoeaError::DirectionCount`] for directions of the caller's that are none.
    pub fn points(&self, objectives: usize, wanted: usize) -> Result<Vec<f64>, MoeaError> {
        match *self {
            Self::Own(ref given) => own(objectives, given.iter().map(Vec::as_slice)),
            Self::Divisions(divisions) => das_dennis(objectives, divisions),
            Self::Layers(outer, inner) => layers(objectives, outer, inner),
            _ if objectives > MOST_OBJECTIVES => das_dennis(objectives, 1),
            Self::FromPopulation => fitting(objectives, wanted),
            Self::Usual => match objectives {
                0 | 1 => das_dennis(objectives, 1),
                2 => das_dennis(2, 99),
                3 => das_dennis(3, 12),
                4 => das_dennis(4, 7),
                5 => das_dennis(5, 6),
                6 => layers(6, 4, 1),
                7 => layers(7, 3, 2),
                8..=10 => layers(objectives, 3, 2),
                _ if direction_count(objectives, 2).is_none() => das_dennis(objectives, 1),
                _ => layers(objectives, 2, 1),
            },
        }
    }
}

fn layers(objectives: usize, outer: usize, inner: usize) -> Result<Vec<f64>, MoeaError> {
    let mut flat = das_dennis(objectives, outer)?;
    let centre = 0.5 / objectives as f64;
    flat.extend(das_dennis(objectives, inner)?.into_iter().map(|z| 0.5 * z + centre));
    Ok(flat)
}

/// Directions of the caller's, each divided by its sum.
pub(super) fn own<'a>(
    objectives: usize,
    given: impl ExactSizeIterator<Item = &'a [f64]>,
) -> Result<Vec<f64>, MoeaError> {
    if given.len() == 0 || given.len() > MOST_DIRECTIONS {
        return Err(MoeaError::DirectionCount { given: given.len(), most: MOST_DIRECTIONS });
    }
    let mut flat = Vec::new();
    for (index, direction) in given.enumerate() {
        let largest = direction.iter().copied().fold(0.0, f64::max);
        let wrong = Unsound::of(direction, objectives, |z| z >= 0.0 && z.is_finite());
        if let Some(found) = wrong.or((largest <= 0.0).then_some(Unsound::Zeros)) {
            return Err(MoeaError::Direction { index, found, wanted: objectives });
        }
        // By the largest first, so that no sum is infinite and no quotient loses its digits.
        let sum: f64 = direction.iter().map(|z| z / largest).sum();
        flat.extend(direction.iter().map(|z| z / largest / sum));
    }
    Ok(flat)
}

/// The finest set of at most `wanted` directions: one layer up to five objectives, two beyond.
fn fitting(objectives: usize, wanted: usize) -> Result<Vec<f64>, MoeaError> {
    let count = |p: usize| direction_count(objectives, p);
    if objectives <= 5 {
        let mut p = 1;
        while objectives > 1 && count(p + 1).is_some_and(|h| h <= wanted) {
            p += 1;
        }
        return das_dennis(objectives, p);
    }
    let fits = |outer: usize, inner: usize| {
        let second = if inner == 0 { 0 } else { count(inner)? };
        count(outer)?.checked_add(second).filter(|total| *total <= wanted)
    };
    let (mut best, mut most) = ((1, 0), 0);
    for outer in (1..).take_while(|outer| fits(*outer, 0).is_some()) {
        for inner in (0..outer).take_while(|inner| fits(outer, *inner).is_some()) {
            let total = fits(outer, inner).unwrap_or(0);
            if total > most {
                (best, most) = ((outer, inner), total);
            }
        }
    }
    let (outer, inner) = best;
    if inner == 0 { das_dennis(objectives, outer) } else { layers(objectives, outer, inner) }
}

/// The `near` directions closest to each direction, itself first.
pub(super) fn neighbours(directions: &[f64], m: usize, near: usize) -> Vec<usize> {
    let all: Vec<&[f64]> = directions.chunks_exact(m.max(1)).collect();
    let by_distance = |a: &(f64, usize), b: &(f64, usize)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
    let near = near.min(all.len());
    let of = |own: &&[f64]| -> Vec<usize> {
        let apart = |other: &&[f64]| other.iter().zip(*own).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        let mut order: Vec<(f64, usize)> = all.iter().map(apart).zip(0..).collect();
        if near < order.len() {
            order.select_nth_unstable_by(near, by_distance);
        }
        order[..near].sort_unstable_by(by_distance);
        order[..near].iter().map(|(_, other)| *other).collect()
    };
    all.par_iter().flat_map_iter(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_those_of_the_closed_form_and_of_deb_and_jain() {
        for (objectives, divisions, count) in
            [(1, 5, 1), (2, 4, 5), (3, 4, 15), (3, 12, 91), (5, 6, 210), (3, 0, 1)]
        {
            let points = das_dennis(objectives, divisions).unwrap();
            assert_eq!(points.len(), count * objectives);
            assert_eq!(direction_count(objectives, divisions), Some(count));
        }
        for (objectives, count) in [(2, 100), (3, 91), (5, 210), (8, 156), (10, 275), (15, 135)] {
            assert_eq!(Directions::Usual.points(objectives, 0).unwrap().len(), count * objectives);
        }
    }

    #[test]
    fn directions_lie_on_the_simplex_and_differ() {
        let points = Directions::Layers(3, 2).points(8, 0).unwrap();
        let mut seen: Vec<&[f64]> = points.chunks_exact(8).collect();
        for point in &seen {
            assert!((point.iter().sum::<f64>() - 1.0).abs() < 1e-15, "{point:?}");
        }
        seen.sort_unstable_by(|a, b| a.partial_cmp(b).unwrap());
        assert!(seen.windows(2).all(|pair| pair[0] != pair[1]));
    }

    #[test]
    fn a_wanted_population_is_filled_but_never_exceeded() {
        for objectives in 2..12 {
            for wanted in [1, 20, 92, 300] {
                let count = Directions::FromPopulation.points(objectives, wanted).unwrap().len() / objectives;
                assert!(count <= wanted.max(objectives), "{objectives} {wanted} {count}");
                assert!(2 * count >= wanted.min(2 * objectives), "{objectives} {wanted} {count}");
            }
        }
        assert_eq!(Directions::FromPopulation.points(3, 92).unwrap().len(), 3 * 91);
        for (objectives, wanted, fit) in [(6, 300, 273), (6, 1000, 918), (7, 1000, 952)] {
            let found = Directions::FromPopulation.points(objectives, wanted).unwrap().len() / objectives;
            assert_eq!(found, fit, "{objectives} {wanted}");
        }
    }

    #[test]
    fn own_directions_are_put_on_the_simplex_or_refused_with_their_numbers() {
        let points =
            |given: &[&[f64]]| Directions::Own(given.iter().map(|z| z.to_vec()).collect()).points(2, 0);
        assert_eq!(
            points(&[&[3.0, 1.0], &[0.0, 1e308], &[1e308, 1e308]]),
            Ok(vec![0.75, 0.25, 0.0, 1.0, 0.5, 0.5])
        );
        let value = |index, value| Unsound::Value { index, value };
        for (wrong, found) in [
            (&[1.0][..], Unsound::Length(1)),
            (&[1.0, -1.0], value(1, -1.0)),
            (&[0.0, 0.0], Unsound::Zeros),
            (&[f64::INFINITY, 1.0], value(0, f64::INFINITY)),
            (&[1.0; 3], Unsound::Length(3)),
        ] {
            let refused = MoeaError::Direction { index: 1, found, wanted: 2 };
            assert_eq!(points(&[&[1.0, 1.0], wrong]), Err(refused), "{wrong:?}");
        }
        assert!(points(&[&[f64::NAN, 1.0]]).is_err());
        assert_eq!(points(&[]), Err(MoeaError::DirectionCount { given: 0, most: MOST_DIRECTIONS }));
    }

    #[test]
    fn too_many_directions_are_refused() {
        assert!(matches!(das_dennis(20, 20), Err(MoeaError::TooManyDirections { divisions: 20, .. })));
    }
}
