TestCase = {}

function TestCase.run()
  angle = 42
  debug.debug()
  rtf.check(angle == 42, 'the angle')
end
