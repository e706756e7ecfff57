"""Many runs: campaigns, their processes, their tables."""
