"""What came out: verdicts, findings, results that introduce themselves."""
