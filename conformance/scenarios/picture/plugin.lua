function TestCase.run()
  rtf.check_picture("scene", "scene.png", "stored.png", 0.01)
  rtf.check_picture("scene", "scene.png", "scene.png", 0.0)
  rtf.check_picture("scene", "scene.png", "golden/none.png", 0.01)
  rtf.report("the test continues")
end
