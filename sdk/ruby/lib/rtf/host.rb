# frozen_string_literal: true

module RTF
  # The host process of Ruby plug-ins: `ruby -e 'require "rtf/host"; RTF::Host.main' --`.
  #
  # It implements spec/protocol.md and runs in the user's `ruby`, so that plug-ins can
  # require the same libraries as the user's shell.
  module Host
    module_function

    # Serves the runner, or checks files with `--check FILE…`. Ends the process
    # only after an error.
    def main(arguments = ARGV)
      if arguments.first == "--check"
        require "rtf/host/check"
        Check.files(arguments.drop(1))
      elsif arguments.any?
        warn "usage: ruby -e 'require \"rtf/host\"; RTF::Host.main' -- [--check FILE...]"
        exit 2
      else
        require "rtf/host/serve"
        status = Serve.serve
        exit status unless status.zero?
      end
    end
  end
end
