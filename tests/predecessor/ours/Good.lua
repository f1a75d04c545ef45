TestCase = {}

function TestCase.run()
  rtf.report("environment " .. rtf.environment())
  rtf.check(rtf.param() == '--rate "1 0"', "the parameters arrive")
end
