//! Fits the commanded motion to samples: least squares over start, speed, both ramps, beginning,
//! way and optionally the servo, by Levenberg-Marquardt (MINPACK, Moré 1978).
//!
//! In these parameters the problem is well conditioned (some tens) if the samples cover both ramps;
//! with speed, acceleration and deceleration it would not converge. A ramp with too few samples is
//! regularised towards the command, and so are all parameters if the samples do not cover the
//! motion (`prior`). Whether the motion was the commanded one follows from the residuals
//! (`choose`).

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn};

use super::prior::{MIN_RAMP_S, Prior, RegularisedParameters, priors};
use super::profile::{Gradient, Profile};

/// One observation: seconds after the origin, angle and its standard deviation in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Observed {
    pub at_s: f64,
    pub angle_deg: f64,
    pub sd_deg: f64,
}

/// A fitted profile.
#[derive(Clone, Debug)]
pub struct ProfileFit {
    /// The motion.
    pub profile: Profile,
    /// Whether the cruise is never reached.
    pub is_triangle: bool,
    /// Condition number of the fit, columns scaled to unit length, priors included.
    pub condition: f64,
    /// Parameters regularised towards the command.
    pub regularised: RegularisedParameters,
    /// Reduced chi-squared: 1 if the samples' errors are as assumed.
    pub reduced_chi2: f64,
    servo: ServoModel,
    covariance: DMatrix<f64>,
    priors: Vec<Prior>,
}

/// Response of the shaft to the demand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ServoModel {
    /// None: the shaft follows at once.
    None,
    /// First order: a lag.
    Lag,
    /// Second order: lag and inertia.
    Swing,
}

impl ServoModel {
    const fn parameters(self) -> usize {
        self as usize
    }

    /// Lags and square roots of the inertia to start fits from, seconds. A servo that swings has
    /// local minima: it starts at 15 Hz and 30 Hz, damped well and little.
    const fn starts(self) -> &'static [[f64; 2]] {
        match self {
            Self::None => &[[0.0; 2]],
            Self::Lag => &[[INITIAL_LAG_S, 0.0]],
            Self::Swing => &[
                [2.0 * INITIAL_LAG_S, INITIAL_LAG_S],
                [0.6 * INITIAL_LAG_S, INITIAL_LAG_S],
                [0.5 * INITIAL_LAG_S, 0.5 * INITIAL_LAG_S],
            ],
        }
    }
}

/// Samples needed within a ramp to determine its length.
const MIN_RAMP_SAMPLES: usize = 3;
/// Above this the samples do not determine all parameters.
const MAX_CONDITION: f64 = 1e6;
/// Relative change of the sum of squares at convergence: with a thousand samples, parameters are
/// then within a tenth of their standard deviation.
const SQUARES_TOLERANCE: f64 = 1e-5;
/// Relative change of the parameters at convergence.
const PARAMETER_TOLERANCE: f64 = 1e-9;
/// Initial lag: that of a servo of 15 Hz.
const INITIAL_LAG_S: f64 = 0.01;
/// Least damping of a tuned servo.
const MIN_DAMPING: f64 = 0.1;
/// Residual of parameters that are no motion.
const INVALID_RESIDUAL: f64 = 1e9;
/// Reduced chi-squared at which the residuals are the samples' errors: no other start fits better.
const FITTED_CHI2: f64 = 1.2;
/// Greatest lag of a servo that moves a head.
const MAX_LAG_S: f64 = 1.0;

impl ProfileFit {
    /// Number of free parameters.
    pub(super) const fn parameters(&self) -> usize {
        ProfileShape::of(self).len()
    }

    /// Standard deviation of the angle at an instant, degrees, from the scatter of the samples.
    #[must_use]
    pub fn sd_deg(&self, at_s: f64) -> f64 {
        let (_, row) = ProfileShape::of(self).row(&self.profile, at_s);
        // There are as many columns as parameters.
        let columns = self.covariance.column_iter().zip(row);
        let variance: f64 = columns
            .map(|(column, by)| by * column.iter().zip(row).map(|(c, by)| c * by).sum::<f64>())
            .sum();
        (variance.max(0.0) * self.reduced_chi2).sqrt()
    }
}

/// The fit of a servo that swings, if the residuals of the fit with a lag show one: the score test
/// (Rao 1948) of a step from that fit towards each start of [`ServoModel::Swing`]. Without one the
/// long search for its parameters finds nothing that cross-validation would choose.
pub(super) fn fit_swing(
    observed: &[Observed],
    guess: Profile,
    lag: Option<&ProfileFit>,
) -> Option<ProfileFit> {
    let mut starts = ServoModel::Swing.starts().to_vec();
    if let Some(lag) = lag {
        let scores = swing_scores(observed, lag);
        // A parameter must pay by the Bayesian information criterion (Schwarz 1978). A score that
        // is no number shows a swing.
        let least = (observed.len() as f64).ln();
        if scores.iter().all(|score| *score < least) {
            return None;
        }
        let mut ordered: Vec<(f64, [f64; 2])> = scores.into_iter().zip(starts).collect();
        ordered.sort_by(|a, b| b.0.total_cmp(&a.0));
        starts = ordered.into_iter().map(|(_, start)| start).collect();
    }
    fit_from(observed, guess, ServoModel::Swing, &starts)
}

/// Scores of a step towards each start of [`ServoModel::Swing`].
fn swing_scores(observed: &[Observed], lag: &ProfileFit) -> Vec<f64> {
    let shape = ProfileShape::of(lag);
    let n = shape.len();
    // Normal equations of the residuals, and of each step. Priors enter by the covariance.
    let starts = ServoModel::Swing
        .starts()
        .iter()
        .map(|&[lag_s, inertia_s]| {
            let profile = Profile {
                start_s: lag.profile.start_s + lag.profile.lag_s - lag_s,
                lag_s,
                inertia_s2: inertia_s * inertia_s,
                ..lag.profile
            };
            (profile, StepSums::new(n))
        });
    let mut starts: Vec<(Profile, StepSums)> = starts.collect();
    for o in observed {
        let (angle_deg, row) = shape.row(&lag.profile, o.at_s);
        let off = (o.angle_deg - angle_deg) / o.sd_deg;
        for (profile, sums) in &mut starts {
            let step = (profile.angle_deg(o.at_s) - angle_deg) / o.sd_deg;
            sums.add(step, off, row.iter().map(|by| by / o.sd_deg));
        }
    }
    let score = |sums: &StepSums| {
        let along = &lag.covariance * &sums.step_by;
        let (step_off, step_step) = (
            sums.step_off - along.dot(&sums.off_by),
            sums.step_step - along.dot(&sums.step_by),
        );
        step_off * step_off / (step_step * lag.reduced_chi2)
    };
    starts.iter().map(|(_, sums)| score(sums)).collect()
}

/// Sums over the observations for one step: products of step, residual and derivatives.
struct StepSums {
    step_step: f64,
    step_off: f64,
    step_by: DVector<f64>,
    off_by: DVector<f64>,
}

impl StepSums {
    fn new(parameters: usize) -> Self {
        Self {
            step_step: 0.0,
            step_off: 0.0,
            step_by: DVector::zeros(parameters),
            off_by: DVector::zeros(parameters),
        }
    }

    fn add(&mut self, step: f64, off: f64, by: impl Iterator<Item = f64>) {
        self.step_step += step * step;
        self.step_off += step * off;
        let sums = self.step_by.iter_mut().zip(self.off_by.iter_mut());
        for ((step_by, off_by), by) in sums.zip(by) {
            *step_by += step * by;
            *off_by += off * by;
        }
    }
}

/// Fits from `guess`. `None` with fewer observations than parameters, or if no minimum is a
/// motion.
pub(super) fn fit(observed: &[Observed], guess: Profile, servo: ServoModel) -> Option<ProfileFit> {
    fit_from(observed, guess, servo, servo.starts())
}

/// The best fit of a servo from several starts.
fn fit_from(
    observed: &[Observed],
    guess: Profile,
    servo: ServoModel,
    starts: &[[f64; 2]],
) -> Option<ProfileFit> {
    let is_triangle = guess.braking_s() <= guess.ramp_up_s;
    let best = |guess: Profile, is_triangle| {
        let shape = ProfileShape { is_triangle, servo };
        let mut best: Option<ProfileFit> = None;
        for &[lag_s, inertia_s] in starts {
            let guess = Profile {
                lag_s,
                inertia_s2: inertia_s * inertia_s,
                ..guess
            };
            let chi2 = |fit: &ProfileFit| fit.reduced_chi2;
            let next = solve(observed, guess, shape);
            best = best
                .into_iter()
                .chain(next)
                .min_by(|a, b| chi2(a).total_cmp(&chi2(b)));
            if best.as_ref().is_some_and(|best| chi2(best) < FITTED_CHI2) {
                break;
            }
        }
        best
    };
    let first = best(guess, is_triangle)?;
    let cruises = first.profile.braking_s() - first.profile.ramp_up_s;
    if !is_triangle && cruises <= 0.0 {
        return best(first.profile, true);
    }
    Some(first)
}

fn solve(observed: &[Observed], guess: Profile, shape: ProfileShape) -> Option<ProfileFit> {
    if observed.len() < shape.len() {
        return None;
    }
    let within = |from: f64, to: f64| {
        let inside = observed.iter().filter(|o| from <= o.at_s && o.at_s <= to);
        inside.count()
    };
    let [up, cruise, brake, rest] = guess.corners_s();
    let regularised = RegularisedParameters {
        ramp_up: within(up, cruise) < MIN_RAMP_SAMPLES,
        ramp_down: within(brake, rest) < MIN_RAMP_SAMPLES,
        ..RegularisedParameters::default()
    };
    let free = Problem::new(observed, guess, shape, regularised).minimise();
    match free {
        Some(free) if free.condition < MAX_CONDITION => Some(free),
        _ => Problem::new(observed, guess, shape, RegularisedParameters::ALL)
            .minimise()
            .map(|fit| {
                let variances = fit.covariance.diagonal();
                let regularised =
                    RegularisedParameters::that_decided(&fit.priors, variances.as_slice());
                ProfileFit { regularised, ..fit }
            }),
    }
}

/// Free parameters of a profile: a triangle's speed follows from its way and its ramps, and the
/// servo is optional.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct ProfileShape {
    is_triangle: bool,
    servo: ServoModel,
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

    /// The parameters: start, ramps, beginning, way, then speed and servo if free.
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

    /// The profile of parameters, limited to possible motions. The way keeps the direction of
    /// `guess`.
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
        let [ramp_up_s, ramp_down_s] = [ramp_up_s, ramp_down_s].map(|s| s.max(MIN_RAMP_S));
        let mut rest = rest.iter().copied();
        let speed_deg_s = if self.is_triangle {
            2.0 * way_deg / (ramp_up_s + ramp_down_s)
        } else {
            rest.next()?
        };
        let lag_s = rest.next().unwrap_or_default();
        // As a time its effect is as linear as the lag's, and symmetric about zero.
        let inertia_s = rest.next().unwrap_or_default().abs().min(MAX_LAG_S);
        let lag_s = lag_s.clamp(MIN_DAMPING * 2.0 * inertia_s, MAX_LAG_S.max(inertia_s));
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

    /// Angle at an instant, and its derivatives by the free parameters.
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

/// The least-squares problem: a row for each observation and each prior.
struct Problem<'a> {
    observed: &'a [Observed],
    guess: Profile,
    shape: ProfileShape,
    regularised: RegularisedParameters,
    profile: Profile,
    parameters: DVector<f64>,
}

impl<'a> Problem<'a> {
    fn new(
        observed: &'a [Observed],
        guess: Profile,
        shape: ProfileShape,
        regularised: RegularisedParameters,
    ) -> Self {
        Self {
            observed,
            guess,
            shape,
            regularised,
            profile: guess,
            parameters: DVector::from_vec(shape.parameters(&guess)),
        }
    }

    /// Priors of the regularised parameters.
    fn priors(&self) -> Vec<Prior> {
        let servo = self.shape.len() - self.shape.servo.parameters()..self.shape.len();
        priors(&self.profile, &self.guess, self.regularised, servo)
    }

    fn minimise(self) -> Option<ProfileFit> {
        let solver = LevenbergMarquardt::new()
            .with_ftol(SQUARES_TOLERANCE)
            .with_xtol(PARAMETER_TOLERANCE)
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
            regularised: problem.regularised,
            reduced_chi2: 2.0 * report.objective_function / freedom as f64,
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
        // The residuals report parameters that are no motion.
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
            // Not a motion: the solver has to step back.
            let rows = self.observed.len() + self.priors().len();
            return Some(DVector::from_element(rows, INVALID_RESIDUAL));
        }
        let off = |o: &Observed| (self.profile.angle_deg(o.at_s) - o.angle_deg) / o.sd_deg;
        let regularised = self
            .priors()
            .into_iter()
            .map(|prior| prior.deviation / prior.sd);
        let rows: Vec<f64> = self.observed.iter().map(off).chain(regularised).collect();
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
            *jacobian.get_mut((self.observed.len() + i, prior.index))? = 1.0 / prior.sd;
        }
        Some(jacobian)
    }
}
