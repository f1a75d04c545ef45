TestCase = {}

function TestCase.run()
  rtf.check(rtf.environment() == "--robot simulator", "the suite's environment arrives")
  rtf.check_near({ 1, 2 }, { 1, 2.001 }, 0.01, "a vector")
  rtf.measure("two", 2, "rad", 1, 3)
end
