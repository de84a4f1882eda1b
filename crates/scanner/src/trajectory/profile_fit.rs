//! Finds the commanded motion in samples: least squares over start, speed, both ramps, beginning,
//! way and, on request, the lag.
//!
//! In these parameters the problem is well posed (condition some tens) as long as the samples see
//! both ramps; speed, acceleration and deceleration instead would not converge. Where a ramp is
//! shorter than what the samples see, its length is held near what was commanded, and where the
//! samples do not tell all of the motion (they begin or end in the midst of it) all parameters are;
//! the fit says which of them that decided. A minimum is found by Levenberg and Marquardt's method
//! (MINPACK's, Moré 1978). Left out: whether the motion was the commanded one at all; residuals
//! tell, and `choose` asks them.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn};

use super::prior::{Prior, RegularisedParameters, SHORTEST_RAMP_S, priors};
use super::profile::{Gradient, Profile};

/// One observation: seconds after the origin, angle and its standard deviation in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Observed {
    pub at_s: f64,
    pub angle_deg: f64,
    pub sd_deg: f64,
}

/// A profile that was found.
#[derive(Clone, Debug)]
pub struct ProfileFit {
    /// The motion.
    pub profile: Profile,
    /// Whether the cruise was never reached.
    pub is_triangle: bool,
    /// Condition number of the fit, its columns scaled to one length, what holds parameters among
    /// them.
    pub condition: f64,
    /// Which parameters were held near what was commanded, as the samples do not tell them.
    pub held: RegularisedParameters,
    /// Weighted sum of squares a degree of freedom: 1 where the samples are as good as they are
    /// taken to be.
    pub excess: f64,
    servo: Servo,
    covariance: DMatrix<f64>,
    priors: Vec<Prior>,
}

/// What is behind the demand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Servo {
    /// A shaft that follows at once.
    None,
    /// A lag.
    Lag,
    /// A lag and inertia.
    Swing,
}

impl Servo {
    const fn parameters(self) -> usize {
        self as usize
    }
}

/// Fewer samples than this within a ramp do not tell its length.
const FEWEST_IN_RAMP: usize = 3;
/// Above this the samples do not tell all parameters.
const WORST_CONDITION: f64 = 1e6;
/// A sum of squares that changes by less than this, as a part of it, is the least: of a thousand
/// samples, parameters are then within a thirtieth of what these scatter them by.
const LEAST: f64 = 1e-6;
/// So many observations are enough for a look.
const ENOUGH_TO_LOOK: usize = 100;
/// Parameters that change by less than this, as a part of them, are found.
const FOUND: f64 = 1e-9;
/// What a lag is looked for from: that of a servo of 15 Hz.
const USUAL_LAG_S: f64 = 0.01;
/// No servo that was tuned swings longer.
const LEAST_DAMPING: f64 = 0.1;
/// A residual that no step leads to.
const FAR_OFF: f64 = 1e9;
/// No servo that moves a head is slower.
const LONGEST_LAG_S: f64 = 1.0;

impl ProfileFit {
    /// Standard deviation of the angle at an instant, degrees, from the scatter of the samples.
    #[must_use]
    pub fn sd_deg(&self, at_s: f64) -> f64 {
        let (_, row) = ProfileShape::of(self).row(&self.profile, at_s);
        // Columns come as many as there are parameters.
        let columns = self.covariance.column_iter().zip(row);
        let variance: f64 = columns
            .map(|(column, by)| by * column.iter().zip(row).map(|(c, by)| c * by).sum::<f64>())
            .sum();
        (variance.max(0.0) * self.excess).sqrt()
    }
}

/// Fits from `guess`, with the servo's parameters that it has, or from where a look has led,
/// `begin`. `None` where there are fewer observations than parameters, or no minimum is found that
/// is a motion at all.
pub(super) fn fit(
    observed: &[Observed],
    guess: Profile,
    servo: Servo,
    begin: Option<&Profile>,
) -> Option<ProfileFit> {
    let [lag_s, inertia_s2] = match servo {
        Servo::None => [0.0; 2],
        Servo::Lag => [USUAL_LAG_S, 0.0],
        Servo::Swing => [2.0 * USUAL_LAG_S, USUAL_LAG_S * USUAL_LAG_S],
    };
    let guess = Profile {
        lag_s,
        inertia_s2,
        ..guess
    };
    let is_triangle = guess.braking_s() <= guess.ramp_up_s;
    let first = solve(observed, guess, ProfileShape { is_triangle, servo }, begin)?;
    let cruises = first.profile.braking_s() - first.profile.ramp_up_s;
    match (is_triangle, cruises > 0.0) {
        (false, false) => solve(
            observed,
            first.profile,
            ProfileShape {
                is_triangle: true,
                servo,
            },
            None,
        ),
        _ => Some(first),
    }
}

fn solve(
    observed: &[Observed],
    guess: Profile,
    shape: ProfileShape,
    begin: Option<&Profile>,
) -> Option<ProfileFit> {
    if observed.len() < shape.len() {
        return None;
    }
    let within = |from: f64, to: f64| {
        let inside = observed.iter().filter(|o| from <= o.at_s && o.at_s <= to);
        inside.count()
    };
    let [up, cruise, brake, rest] = guess.corners_s();
    let held = RegularisedParameters {
        ramp_up: within(up, cruise) < FEWEST_IN_RAMP,
        ramp_down: within(brake, rest) < FEWEST_IN_RAMP,
        ..RegularisedParameters::default()
    };
    let free = Problem::new(observed, guess, shape, held)
        .beginning_at(begin.unwrap_or(&guess))
        .minimise();
    match free {
        Some(free) if free.condition < WORST_CONDITION => Some(free),
        _ => Problem::new(observed, guess, shape, RegularisedParameters::ALL)
            .minimise()
            .map(|fit| {
                let variances = fit.covariance.diagonal();
                let held = RegularisedParameters::that_decided(&fit.priors, variances.as_slice());
                ProfileFit { held, ..fit }
            }),
    }
}

/// A fit to one observation in every few, for a look at what it comes to; `None` where there are
/// too few for that, or they do not tell everything.
pub(super) fn look(observed: &[Observed], guess: Profile, servo: Servo) -> Option<ProfileFit> {
    let part = observed.len() / ENOUGH_TO_LOOK;
    if part < 2 {
        return None;
    }
    let some: Vec<Observed> = observed.iter().copied().step_by(part).collect();
    fit(&some, guess, servo, None).filter(|fit| !fit.held.any())
}

/// Which parameters a profile has: a triangle's speed follows from its way and its ramps, and there
/// may be no lag.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct ProfileShape {
    is_triangle: bool,
    servo: Servo,
}

impl ProfileShape {
    const fn of(fit: &ProfileFit) -> Self {
        Self {
            is_triangle: fit.is_triangle,
            servo: fit.servo,
        }
    }

    const fn len(self) -> usize {
        5 + !self.is_triangle as usize + self.servo.parameters()
    }

    /// The parameters: start, ramps, beginning, way, then speed and lag where they are free.
    fn parameters(self, profile: &Profile) -> Vec<f64> {
        let Profile {
            start_s,
            speed_deg_s,
            ramp_up_s,
            ramp_down_s,
            from_deg,
            way_deg,
            lag_s,
            inertia_s2,
        } = *profile;
        let mut parameters = vec![start_s, ramp_up_s, ramp_down_s, from_deg, way_deg];
        parameters.extend((!self.is_triangle).then_some(speed_deg_s));
        parameters.extend(
            [lag_s, inertia_s2.sqrt()]
                .into_iter()
                .take(self.servo.parameters()),
        );
        parameters
    }

    /// The profile of parameters, which are first brought to where a motion is possible. The way
    /// never changes its direction from that of `guess`.
    fn profile(self, parameters: &[f64], guess: &Profile) -> Option<Profile> {
        let &[
            start_s,
            ramp_up_s,
            ramp_down_s,
            from_deg,
            way_deg,
            ref rest @ ..,
        ] = parameters
        else {
            return None;
        };
        let [ramp_up_s, ramp_down_s] = [ramp_up_s, ramp_down_s].map(|s| s.max(SHORTEST_RAMP_S));
        let mut rest = rest.iter().copied();
        let speed_deg_s = if self.is_triangle {
            2.0 * way_deg / (ramp_up_s + ramp_down_s)
        } else {
            rest.next()?
        };
        let lag_s = rest.next().unwrap_or_default();
        // As a time its effect is as even as the lag's, and on both sides of zero the same.
        let inertia_s = rest.next().unwrap_or_default().abs().min(LONGEST_LAG_S);
        let lag_s = lag_s.clamp(
            LEAST_DAMPING * 2.0 * inertia_s,
            LONGEST_LAG_S.max(inertia_s),
        );
        let inertia_s2 = inertia_s * inertia_s;
        let is_motion = way_deg * guess.way_deg > 0.0
            && speed_deg_s * guess.speed_deg_s > 0.0
            && parameters.iter().all(|p| p.is_finite());
        is_motion.then_some(Profile {
            start_s,
            speed_deg_s,
            ramp_up_s,
            ramp_down_s,
            from_deg,
            way_deg,
            lag_s,
            inertia_s2,
        })
    }

    /// Angle at an instant and its derivatives by the parameters, of which as many count as there
    /// are.
    fn row(self, profile: &Profile, at_s: f64) -> (f64, Gradient) {
        let (angle, [start, speed, up, down, from, way, lag, inertia]): (f64, Gradient) =
            profile.with_gradient(at_s);
        let inertia = 2.0 * profile.inertia_s2.sqrt() * inertia;
        let row = if self.is_triangle {
            let by_ramps = -profile.speed_deg_s / (profile.ramp_up_s + profile.ramp_down_s);
            let by_way = profile.speed_deg_s / profile.way_deg;
            [
                start,
                up + speed * by_ramps,
                down + speed * by_ramps,
                from,
                way + speed * by_way,
                lag,
                inertia,
                0.0,
            ]
        } else {
            [start, up, down, from, way, speed, lag, inertia]
        };
        (angle, row)
    }
}

/// The problem as the solver sees it: one row an observation, and one for each parameter that is
/// held.
struct Problem<'a> {
    observed: &'a [Observed],
    guess: Profile,
    shape: ProfileShape,
    held: RegularisedParameters,
    profile: Profile,
    parameters: DVector<f64>,
}

impl<'a> Problem<'a> {
    fn new(
        observed: &'a [Observed],
        guess: Profile,
        shape: ProfileShape,
        held: RegularisedParameters,
    ) -> Self {
        Self {
            observed,
            guess,
            shape,
            held,
            profile: guess,
            parameters: DVector::from_vec(shape.parameters(&guess)),
        }
    }

    fn beginning_at(mut self, start: &Profile) -> Self {
        self.set_params(&DVector::from_vec(self.shape.parameters(start)));
        self
    }

    /// What holds parameters.
    fn priors(&self) -> Vec<Prior> {
        let servo = self.shape.len() - self.shape.servo.parameters()..self.shape.len();
        priors(&self.profile, &self.guess, self.held, servo)
    }

    fn minimise(self) -> Option<ProfileFit> {
        let solver = LevenbergMarquardt::new()
            .with_ftol(LEAST)
            .with_xtol(FOUND)
            .with_gtol(0.0)
            .with_patience(30);
        let (problem, report) = solver.minimize(self);
        if !report.objective_function.is_finite() {
            return None;
        }
        let profile = problem
            .shape
            .profile(problem.parameters.as_slice(), &problem.guess)?;
        let jacobian = problem.jacobian()?;
        let lengths: Vec<f64> = jacobian
            .column_iter()
            .map(|c| c.norm().max(f64::MIN_POSITIVE))
            .collect();
        let n = lengths.len();
        let scale =
            DMatrix::from_diagonal(&DVector::from_iterator(n, lengths.iter().map(|l| 1.0 / l)));
        let normal = &scale * jacobian.transpose() * &jacobian * &scale;
        let eigen = normal.clone().symmetric_eigen().eigenvalues;
        let (least, most) = (eigen.min(), eigen.max());
        let condition = if least > 0.0 {
            (most / least).sqrt()
        } else {
            f64::INFINITY
        };
        let inverse = normal.pseudo_inverse(f64::EPSILON * n as f64).ok()?;
        let freedom = (problem.observed.len() + problem.priors().len())
            .saturating_sub(n)
            .max(1);
        Some(ProfileFit {
            profile,
            is_triangle: problem.shape.is_triangle,
            condition,
            held: problem.held,
            excess: 2.0 * report.objective_function / freedom as f64,
            servo: problem.shape.servo,
            covariance: &scale * inverse * &scale,
            priors: problem.priors(),
        })
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Problem<'_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, parameters: &DVector<f64>) {
        self.parameters.copy_from(parameters);
        // Where no motion has these parameters the residuals say so.
        if let Some(profile) = self.shape.profile(parameters.as_slice(), &self.guess) {
            self.profile = profile;
        }
    }

    fn params(&self) -> DVector<f64> {
        self.parameters.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        if self
            .shape
            .profile(self.parameters.as_slice(), &self.guess)
            .is_none()
        {
            // No motion has these parameters: the solver is to turn back.
            let rows = self.observed.len() + self.priors().len();
            return Some(DVector::from_element(rows, FAR_OFF));
        }
        let off = |o: &Observed| (self.profile.angle_deg(o.at_s) - o.angle_deg) / o.sd_deg;
        let held = self.priors().into_iter().map(|prior| prior.off / prior.sd);
        let rows: Vec<f64> = self.observed.iter().map(off).chain(held).collect();
        Some(DVector::from_vec(rows))
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let priors = self.priors();
        let mut jacobian = DMatrix::zeros(self.observed.len() + priors.len(), self.shape.len());
        for (i, o) in self.observed.iter().enumerate() {
            let (_, row) = self.shape.row(&self.profile, o.at_s);
            for (k, by) in row.into_iter().take(self.shape.len()).enumerate() {
                *jacobian.get_mut((i, k))? = by / o.sd_deg;
            }
        }
        for (i, prior) in priors.into_iter().enumerate() {
            *jacobian.get_mut((self.observed.len() + i, prior.place))? = 1.0 / prior.sd;
        }
        Some(jacobian)
    }
}
