// SPDX-License-Identifier: Apache-2.0
#include <rtf/TestCase.hpp>

class Picture : public rtf::TestCase
{
public:
    void run() override
    {
        check_picture("scene", "scene.png", "stored.png", 0.01);
        check_picture("scene", "scene.png", "scene.png", 0.0);
        check_picture("scene", "scene.png", "golden/none.png", 0.01);
        report("the test continues");
    }
};

RTF_PLUGIN(Picture);
