function TestCase.run()
  rtf.sample("q", 0, "rad", nil, nil, 0.5)
  rtf.sample("q", 1, "rad", nil, nil, 1.5)
  rtf.sample("q", 1, "rad", nil, nil, 2.5)
  rtf.check_trajectory("q", "golden/a.csv", 0.05)
  rtf.check_trajectory("q", "golden/b.csv", 0.5, "dtw", 0.25)
  rtf.report("the test continues")
end
