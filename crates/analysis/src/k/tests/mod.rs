mod cosines;
mod equality;
mod estimates;
mod hard_cases;
mod patterns;
mod truths;
