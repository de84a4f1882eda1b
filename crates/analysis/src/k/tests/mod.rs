mod cosines;
mod hard_cases;
mod patterns;
mod truths;
