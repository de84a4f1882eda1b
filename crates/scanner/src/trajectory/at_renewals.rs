//! Candidates through samples at the renewals of a latch.

use std::borrow::Cow;

use units::Span;

use super::AngleSample;
use super::candidate::Candidate;
use super::choose::Candidates;
use super::latch::{self, LatchEvidence};
use super::observations::observed;
use super::renewals::Renewals;

/// Rounds in which samples are moved to the renewals that a curve shows: a better curve shows more.
const RENEWED: usize = 3;

impl<'a> Candidates<'a> {
    /// The same with samples at the renewals of the positions, which `best` shows; `None` if it
    /// shows no latch.
    pub(super) fn at_renewals(&self, best: &Candidate) -> Option<Self> {
        if self.renewed == RENEWED || best.latch != LatchEvidence::Present {
            return None;
        }
        let residuals = self.residuals(self.polled, &best.unshifted);
        let renewals = Renewals::find(&residuals, self.noise.angle_sd_deg)?;
        let mut residuals = residuals.iter().peekable();
        let mut samples: Vec<AngleSample> = Vec::with_capacity(self.polled.len());
        let mut unit_deg = Vec::with_capacity(self.polled.len());
        let polled = observed(self.polled, &self.noise, self.origin);
        for (sample, polled) in self.polled.iter().zip(polled) {
            let at_s = sample.host.saturating_since(self.origin).as_secs_f64();
            let residual = residuals.next_if(|residual| residual.at_s == at_s);
            let renewed = residual.and_then(|residual| renewals.instant_s(residual));
            let sample = match renewed {
                Some(at_s) => AngleSample {
                    host: self.origin.saturating_add(Span::from_secs_f64(at_s)),
                    bound: latch::RENEWAL_BOUND,
                    ..*sample
                },
                None => *sample,
            };
            // Several polls may see one renewal.
            if samples.last().is_none_or(|last| last.host < sample.host) {
                samples.push(sample);
                unit_deg.push(polled.sd_deg);
            }
        }
        Some(Self {
            observed: observed(&samples, &self.noise, self.origin),
            samples: Cow::Owned(samples),
            unit_deg,
            renewed: self.renewed + 1,
            renewals: Some(renewals),
            sweep: self.sweep,
            polled: self.polled,
            noise: self.noise,
            origin: self.origin,
        })
    }
}
