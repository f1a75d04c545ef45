require "rtf"

class ExitZero < RTF::TestCase
  def run
    check(false, "already wrong")
    exit(0)
  end
end
