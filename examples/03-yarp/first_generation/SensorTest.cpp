// Do six values arrive? Written for RTF 1.x, and built unchanged.
#include <rtf/TestAssert.h>
#include <rtf/TestCase.h>
#include <rtf/dll/Plugin.h>
#include <yarp/os/BufferedPort.h>
#include <yarp/os/Network.h>
#include <yarp/os/Property.h>
#include <yarp/sig/Vector.h>

#include <string>

class SensorTest : public RTF::TestCase
{
public:
    SensorTest() : RTF::TestCase("SensorTest") {}

    virtual bool setup(int argc, char **argv)
    {
        yarp::os::Property options;
        options.fromCommand(argc, argv);
        RTF_ASSERT_ERROR_IF(options.check("from"), "tell the port: --from /name");
        const std::string from = options.find("from").asString();
        RTF_ASSERT_ERROR_IF(port.open("/SensorTest/values:i"), "cannot open a port");
        RTF_ASSERT_ERROR_IF(yarp.connect(from, port.getName()), "cannot connect to " + from);
        RTF_TEST_REPORT("connected to " + from);
        return true;
    }

    virtual void tearDown()
    {
        port.interrupt();
        port.close();
    }

    virtual void run()
    {
        for (int i = 0; i < 20; ++i) {
            const yarp::sig::Vector *values = port.read();
            RTF_ASSERT_FAIL_IF(values != NULL, "no values arrive");
            RTF_TEST_FAIL_IF(values->size() == 6,
                             RTF::Asserter::format("%zu values, not 6", values->size()));
        }
        RTF_TEST_CHECK(true, "six values arrive");
    }

private:
    yarp::os::Network yarp;
    yarp::os::BufferedPort<yarp::sig::Vector> port;
};

PREPARE_PLUGIN(SensorTest)
