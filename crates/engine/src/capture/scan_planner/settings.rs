//! The settings among which a plan chooses.

use std::collections::HashMap;

use analysis::plan::{PlannedScan, ScanSetting, TiltSweep};
use units::Rpm;

use super::ScanPlanner;
use crate::capture::moves::Step;
use crate::capture_request::CaptureRequest;

/// Gentlest ramp to choose from, as a part of the device's: a gentler one loads no head more.
const GENTLEST: f64 = 0.03;
/// Numbers of sweeps to choose from.
const SWEEPS: [u32; 2] = [1, 2];
/// Ratios of a chosen speed, and of its ramps, to those between it and the next of the search.
const NEARBY_SPEEDS: [f64; 4] = [0.99, 1.0, 1.01, 1.02];
const NEARBY_RAMPS: [f64; 4] = [0.94, 1.0, 1.06, 1.13];
/// Ratio of durations of a sweep below which ramps are alike.
const ALIKE: f64 = 1.001;

impl ScanPlanner {
    /// Every setting, with speeds and ramps in such ratios.
    #[must_use]
    pub fn scans(&self, [speed_ratio, ramp_ratio]: [f64; 2]) -> Vec<PlannedScan> {
        let most = self.axis.max_speed.0;
        let mut speeds = vec![most];
        let mut next = f64::from(most) / speed_ratio;
        while next >= 1.0 {
            let rpm = next.round() as u32;
            if speeds.last() != Some(&rpm) {
                speeds.push(rpm);
            }
            // Whole revolutions: slow speeds are more than the ratio apart.
            next = (next / speed_ratio).min(f64::from(rpm) - 0.5);
        }
        let ramps: Vec<f64> = std::iter::successors(Some(1.0), |ramp| Some(ramp / ramp_ratio))
            .take_while(|ramp| *ramp > GENTLEST)
            .chain([GENTLEST])
            .collect();
        self.scans_of(&speeds, &ramps)
    }

    /// The same without those of which the ramps make hardly a difference.
    pub(super) fn different_scans(&self, ratios: [f64; 2]) -> Vec<PlannedScan> {
        let mut scans = self.scans(ratios);
        let mut last = HashMap::new();
        scans.retain(|scan| {
            let setting = &scan.setting;
            let sweep_s: f64 = scan.sweeps.iter().map(TiltSweep::duration_s).sum();
            let others = (setting.rpm.to_bits(), setting.sweeps);
            // Ramps of one speed follow each other, the steepest first.
            let is_alike = last.get(&others).is_some_and(|(speed, last_s)| {
                *speed == setting.speed_deg_s && sweep_s < ALIKE * last_s
            });
            if !is_alike {
                last.insert(others, (setting.speed_deg_s, sweep_s));
            }
            !is_alike
        });
        scans
    }

    /// Settings between one and its neighbours in the search.
    pub(super) fn nearby(&self, setting: &ScanSetting) -> Vec<PlannedScan> {
        let gearing = self.axis.gearing;
        let most = self.axis.max_speed.0;
        let rpm = f64::from(most) * setting.speed_deg_s / gearing.rate(Rpm(most)).0;
        let mut speeds: Vec<u32> = NEARBY_SPEEDS
            .into_iter()
            .map(|ratio| ((ratio * rpm).round() as u32).min(most))
            .collect();
        speeds.dedup();
        let ramp = setting.accel_deg_s2 / self.device.accel_deg_s2;
        let mut ramps = NEARBY_RAMPS
            .map(|ratio| (ratio * ramp).clamp(GENTLEST, 1.0))
            .to_vec();
        ramps.dedup();
        self.scans_of(&speeds, &ramps)
    }

    fn scans_of(&self, speeds: &[u32], ramps: &[f64]) -> Vec<PlannedScan> {
        let of_speed = |speed: &u32| {
            let settings = ramps.iter().flat_map(|ramp| SWEEPS.map(|n| (ramp, n)));
            // A ramp that the axis refuses is no setting.
            let moves = settings.filter_map(|(ramp, sweeps)| self.reached(*speed, *ramp, sweeps));
            let scans = moves.flat_map(|steps| {
                let rates = self.request.rpm.iter();
                rates.map(|rpm| self.scan(&steps, *rpm)).collect::<Vec<_>>()
            });
            // Of speeds that a sweep does not reach, the lowest is the same scan.
            let slower = speeds.iter().filter(|slower| *slower < speed).max();
            let slower = slower.map_or(0.0, |slower| self.axis.gearing.rate(Rpm(*slower)).0);
            let reaches = |sweep: &TiltSweep| sweep.peak_deg_s() > slower;
            let differ = scans.filter(|scan| scan.sweeps.iter().all(reaches));
            differ.collect::<Vec<_>>()
        };
        speeds.iter().flat_map(of_speed).collect()
    }

    /// The moves at a speed, or at the lowest that gives the same where the axis does not reach it.
    fn reached(&self, speed: u32, ramp: f64, sweeps: u32) -> Option<Vec<Step>> {
        let steps = |rpm| self.steps(&self.capture(Rpm(rpm), ramp, sweeps)).ok();
        let moves = steps(speed)?;
        let peak_deg_s = self.scan(&moves, 0).sweeps.first()?.peak_deg_s();
        let reached = (peak_deg_s / self.axis.gearing.rate(Rpm(1)).0).ceil() as u32;
        match reached < speed {
            true => steps(reached),
            false => Some(moves),
        }
    }

    /// A capture with a part of the device's ramps.
    pub(super) fn capture(&self, speed: Rpm, ramp: f64, sweeps: u32) -> CaptureRequest {
        CaptureRequest {
            speed_deg_s: self.axis.gearing.rate(speed).0,
            accel_deg_s2: Some(ramp * self.device.accel_deg_s2),
            both_ways: sweeps > 1,
            sweeps: Some(sweeps),
            from_deg: self.request.from_deg,
            to_deg: self.request.to_deg,
            ..CaptureRequest::default()
        }
    }
}
