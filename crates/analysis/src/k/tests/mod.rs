mod cosines;
mod equality;
mod estimates;
mod hard_cases;
mod leaves;
mod patterns;
mod truths;
